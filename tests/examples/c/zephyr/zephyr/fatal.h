/* What the example uses of Zephyr, as its headers declare it. */
#ifndef ZEPHYR_FATAL_H
#define ZEPHYR_FATAL_H

struct arch_esf;

void k_fatal_halt(unsigned int reason) __attribute__((noreturn));
void k_sys_fatal_error_handler(unsigned int reason, const struct arch_esf *esf);

#endif
