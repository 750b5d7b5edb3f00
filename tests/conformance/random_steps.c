/* A run in steps of random lengths: the traces have to be those of csp_run, whose place this file takes. Between the steps its state moves to another address, by
 * way of a copy without pointers, and the memory where it was is overwritten.
 *
 * SEED is a number, which selects the steps. What csp_begin, csp_advance and csp_next promise is checked on the way.
 */
#include "csp_internal.h"
#include "csp_port.h"
#include "network.h"
#include "network_pointers.h"

#include <stdio.h>
#include <stdlib.h>

static uint64_t state = SEED;

/* Knuth's linear congruential generator; its upper bits are good enough to choose steps. */
static uint32_t chosen(uint32_t count)
{
    state = (state * UINT64_C(6364136223846793005)) + UINT64_C(1442695040888963407);
    return (uint32_t)(state >> 33) % count;
}

static void require(bool condition, const char *promise)
{
    if (!condition) {
        (void)fprintf(stderr, "broken: %s\n", promise);
        exit(EXIT_FAILURE);
    }
}

/* Between nothing and some tens of milliseconds, or up to the next instant, or just before it. */
static int64_t next_end(csp_kernel *csp, int64_t from)
{
    static const int64_t units[] = {1, 1000, 100000, 1000000, 10000000};
    const int64_t due = csp_next(csp);
    switch (chosen(4U)) {
    case 0U:
        return from;
    case 1U:
        return (due <= CSP_END_OF_TIME) ? due : from;
    case 2U:
        return ((due > from) && (due < CSP_END_OF_TIME)) ? (due - 1) : from;
    default:
        return from + (units[chosen(5U)] * (int64_t)chosen(8U));
    }
}

/* Not beyond the next change of a parameter, which is made before everything else at its instant. */
static int64_t before_change(csp_kernel *csp, int64_t end, int64_t last)
{
    const csp_tuning *const tuning = csp->program->tuning;
    const int64_t next = csp_next(csp);
    if ((tuning == NULL) || (next > last)) {
        return end;
    }
    if ((tuning->next() <= next) && (end >= next)) {
        tuning->make(csp, next);
    }
    return ((tuning->next() <= end) && (end >= next)) ? (tuning->next() - 1) : end;
}

static uint32_t some_steps(void)
{
    return (chosen(3U) == 0U) ? 65536U : chosen(5U);
}

static struct network copy;
static struct network again;

/* A copy of the state without pointers. */
static void save(struct network *to, const struct network *from)
{
    csp_pointer_visit visits[CSP_NETWORK_DEPTH];
    const csp_saved_places places = {from, sizeof *from, &network_program};
    (void)memcpy(to, from, sizeof *from);
    csp_save_pointers(to, &network_pointers, visits, places);
}

/* Moves the state to another address; returns the kernel there. */
static csp_kernel *moved(struct network *to, struct network *from)
{
    csp_pointer_visit visits[CSP_NETWORK_DEPTH];
    const csp_saved_places places = {to, sizeof *to, &network_program};
    save(&copy, from);
    (void)memset(from, 0xA5, sizeof *from);
    (void)memcpy(to, &copy, sizeof *to);
    csp_restore_pointers(to, &network_pointers, visits, places);
    save(&again, to);
    require(memcmp(&again, &copy, sizeof copy) == 0, "a copy does not depend on where the state is");
    csp_own(&to->kernel);
    return &to->kernel;
}

csp_ending csp_run(csp_kernel *given, int64_t until)
{
    static struct network other;
    struct network *const home = (struct network *)(void *)given;
    csp_kernel *csp = given;
    const int64_t last = ((until >= 0) && (until < CSP_END_OF_TIME)) ? until : CSP_END_OF_TIME;
    int64_t end = 0;
    csp_own(csp);
    csp_ending ending = csp_begin(csp);
    if (ending == CSP_NOT_INITIALIZED) {
        return ending;
    }
    require(csp_begin(csp) == CSP_NOT_INITIALIZED, "a network is built before each run");
    csp_port_start();
    while ((ending == CSP_BUDGET) || ((ending == CSP_MORE) && (end < last))) {
        if (ending == CSP_MORE) {
            end = next_end(csp, end);
            end = before_change(csp, (end < last) ? end : last, last);
        }
        if (chosen(3U) == 0U) {
            csp = (csp == given) ? moved(&other, home) : moved(home, &other);
        }
        ending = csp_advance(csp, end, some_steps());
        if (ending == CSP_MORE) {
            require(csp_next(csp) > end, "after a step nothing is due");
            require(csp_advance(csp, end - 1, 1U) == CSP_REFUSED, "a step backwards is refused");
        } else if (ending == CSP_BUDGET) {
            require(csp_next(csp) <= end, "when the steps are used up, something is due");
        } else {
            require(csp_next(csp) == INT64_MAX, "after the end nothing is due");
            require(csp_advance(csp, end, 1U) == ending, "a run that has ended answers in the same way again");
        }
    }
    csp = (csp == given) ? csp : moved(home, &other);
    if (ending == CSP_MORE) {
        require(csp_advance(csp, INT64_MAX, 1U) == CSP_REFUSED, "a step beyond the end of time is refused");
        ending = CSP_TIME_LIMIT;
        csp->now = last;
    }
    csp_finish(csp);
    require(csp_advance(csp, end, 1U) == ((ending == CSP_TIME_LIMIT) ? CSP_NOT_INITIALIZED : ending),
            "no step after the end, and the same answer");
    csp_port_finish(csp);
    return ending;
}
