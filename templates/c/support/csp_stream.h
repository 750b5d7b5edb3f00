/* SPDX-License-Identifier: 0BSD */
/* The events of a run, as records on standard output for the process that started it.
 *
 * A record is a row of 32 bytes, in the byte order of the machine: kind (4 bytes), number (4), time (8), writer (4), reader (4), value (8). The kinds, with
 * what their fields mean; what is not named is 0:
 *
 *     0  the record before continues: 24 bytes, from the time on, of its value or text
 *     1  a channel: its number, the size of its values as writer; a text follows: its name
 *     2  a process or group: its number; two texts follow: its name, and its definition ("" for a group)
 *     3  a communication: the number of the channel, writer, reader, the first 8 bytes of the value
 *     4  a process or group begins: its number;  5  ends
 *     6  a safe value is written: the number of the channel, the first 8 bytes of the value
 *     7  a text: its length as number, then, from the time on, its first 24 bytes
 *     8  a process that waits when nothing can continue: its number; four texts follow: name, place of its definition, where it waits, for what
 *     9  missed samples: the number of the port, their count as writer
 *    10  the end: csp_ending as number, duration of the run in seconds (a double) as value; three texts follow: exception ("": the environment failed),
 *        message, place
 *    11  execution times, with CSP_MEASURE: the number of a process, its longest step in nanoseconds as time, the number of its steps as value
 *    12  a sample of a sampled input, read or not: the number of the channel, the first 8 bytes of the value
 *    13  the process before waits at a channel: its number, and 2^32 - 1 as writer; then, for each end of a broadcast that has not taken the value, the same with
 *        the number of that end
 *    14  the present instant, as time; if the run waits to be steered, 1 as writer, as reader whether it has reached the instant of its order,
 *        the next instant as value
 *    15  a change of a parameter: its number, the instant at which it is made as time, 1 as value; 0: it was refused
 *
 * So a reader finds the records of one kind without reading the others. Whole records are sent: when there are many, ten times a second, and when the program
 * is ended by force.
 */
#ifndef CSP_STREAM_H
#define CSP_STREAM_H

#include "csp_simulation.h"

/* Which communications are reported. Silent: nothing at all; signals: those of ports but for reads of sampled inputs, whose samples are reported. */
typedef enum csp_observed {
    CSP_SILENT,
    CSP_OBSERVE_NONE,
    CSP_OBSERVE_SIGNALS,
    CSP_OBSERVE_PORTS,
    CSP_OBSERVE_ALL
} csp_observed;

/* To be called before the run. */
void csp_stream_begin(csp_kernel *csp, const csp_names *names, csp_observed observed);
/* Reports the present instant and the samples that were missed until then, between two turns of the run. */
void csp_stream_present(csp_kernel *csp);
/* Reports that the run waits to be steered (csp_steering.h), and sends everything. */
void csp_stream_held(csp_kernel *csp, bool reached, int64_t next);
/* Reports the processes that wait, between two steps, in the records for a deadlock. */
void csp_stream_waiting(csp_kernel *csp);
/* How many communications were reported. */
uint64_t csp_stream_communications(void);
/* Reports a change of a parameter, before anything happens at the instant. */
void csp_stream_change(csp_kernel *csp, uint32_t number, int64_t instant, bool made);
/* To be called after the run; false: not everything could be written. */
bool csp_stream_end(csp_kernel *csp, csp_ending ending, double duration);

#endif
