/* Standard output of a program in virtual time on a bare machine, by semihosting. */
#include <stdint.h>
#include <stdio.h>

#include "csp_port.h"

enum { WRITE_CHARACTER = 0x03, EXIT = 0x18, APPLICATION_EXIT = 0x20026, RUN_TIME_ERROR = 0x20023 };

int _write(int file, const char *text, int length);

static void semihost(uintptr_t operation, uintptr_t argument)
{
    register uintptr_t number __asm__("r0") = operation;
    register uintptr_t value __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(number) : "r"(value) : "memory");
}

/* Called by the C library. */
int _write(int file, const char *text, int length)
{
    (void)file;
    for (int index = 0; index < length; index++) {
        semihost(WRITE_CHARACTER, (uintptr_t)&text[index]);
    }
    return length;
}

void csp_port_write(const char *text)
{
    (void)fputs(text, stdout);
}

void csp_port_exit(bool successful)
{
    (void)fflush(stdout);
    semihost(EXIT, successful ? (uintptr_t)APPLICATION_EXIT : (uintptr_t)RUN_TIME_ERROR);
    for (;;) {
    }
}

void csp_port_tick(void)
{
}
