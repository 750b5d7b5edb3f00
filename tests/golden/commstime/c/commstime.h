/* The natural numbers, made by four processes in a circle.
 *
 * Source: commstime.csp:60
 */
#ifndef COMMSTIME_H
#define COMMSTIME_H

#include "csp.h"
#include "types.h"
#include "prefix.h"
#include "delta.h"
#include "successor.h"
#include "consumer.h"

struct commstime {
    csp_process process;
    csp_channel a;
    csp_channel b;
    csp_channel c;
    csp_channel d;
    struct prefix prefix;
    struct delta delta;
    struct successor successor;
    struct consumer consumer;
    csp_parallel parallel;
};

/* Before the program starts. */
void commstime_initialize(struct commstime *self, csp_numbers *numbers, int64_t rounds);

#endif
