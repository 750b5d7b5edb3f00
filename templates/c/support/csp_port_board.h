/* SPDX-License-Identifier: 0BSD */
/* A board whose host, a debugger or an emulator, serves it by semihosting: the command line, one file for the records of a run, texts and the exit status.
 * The simulation runs on it in virtual time, so its trace is that of every other machine. */
#ifndef CSP_PORT_BOARD_H
#define CSP_PORT_BOARD_H

#include <stdint.h>

/* A call of the host: the operation, and the address of what it needs; see the semihosting specification of Arm, which RISC-V has adopted. */
intptr_t csp_board_call(uint32_t operation, const void *argument);

/* To be called after reset, with memory initialized as C requires: calls main with the words of the command line; does not return. */
void csp_board_start(void);

/* Ends the program with an exit status; does not return. */
void csp_board_exit(int status);

/* To be called by the handlers of faults; does not return. */
void csp_board_fault(void);

#endif
