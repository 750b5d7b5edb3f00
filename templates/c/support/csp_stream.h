/* The events of a run, as records on standard output for the process that started it.
 *
 * A record is a byte for its kind, followed by its fields: numbers in the byte order of the machine, texts after their
 * length in two bytes:
 *
 *     1  a channel: number (4 bytes), size of its values (2), name
 *     2  a process or group: number (4), name, definition ("" for a group)
 *     3  a communication: time (8), channel (4), writer (4), reader (4), value
 *     4  a process or group begins: time (8), number (4);  5  ends
 *     6  a safe value is written: time (8), channel (4), value
 *     8  a process that waits when nothing can continue: number (4), name, place of its definition, where it waits, for what, channels (2, then 4 each)
 *     9  missed samples of a port: channel (4), count (4)
 *    10  the end: csp_ending (1), time (8), duration of the run in seconds (8, a double), exception ("": the environment failed), message, place
 *    11  execution times, with CSP_MEASURE: number of a process (4), its longest step in nanoseconds (8), number of its steps (8)
 *    12  a sample of a sampled input, read or not: time (8), channel (4), value
 *
 * Whole records are sent: when there are many, ten times a second, and when the program is ended by force.
 */
#ifndef CSP_STREAM_H
#define CSP_STREAM_H

#include "csp_simulation.h"

/* Which communications are reported; silent: nothing at all. */
typedef enum csp_observed { CSP_SILENT, CSP_OBSERVE_NONE, CSP_OBSERVE_PORTS, CSP_OBSERVE_ALL } csp_observed;

/* To be called before the run. */
void csp_stream_begin(const csp_program *program, const csp_names *names, csp_observed observed);
/* To be called after the run; false: not everything could be written. */
bool csp_stream_end(const csp_program *program, csp_ending ending, double duration);

#endif
