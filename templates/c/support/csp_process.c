/* SPDX-License-Identifier: 0BSD */
/* How processes begin, end and fail; branches of parallels. */
#include "csp_arithmetic.h"
#include "csp_internal.h"

static void clear_error(csp_kernel *csp)
{
    (void)memset(&csp->error, 0, sizeof csp->error);
}

void csp_process_init(csp_process *process, const csp_class *kind, uint32_t number)
{
    process->kind = kind;
    process->above = NULL;
    process->party.step = kind->step;
    process->party.number = number;
    process->party.flags = CSP_ENDED;
}

static inline size_t number_of(const csp_process *process)
{
    return (process->kind->stride == 0U) ? 0U : (size_t)CSP_NUMBER(process);
}

/* The distance in bytes from a process to the object at `offset` in its struct; the objects of csp_numbered processes are `stride` bytes apart. */
static inline ptrdiff_t way_to(const csp_process *process, size_t offset, size_t stride)
{
    const size_t number = number_of(process);
    const size_t before = process->kind->offset + (number * process->kind->stride);
    return (ptrdiff_t)(offset + (number * stride)) - (ptrdiff_t)before;
}

/* Instead of the place of a process whose state is none of its class; nor is the one in which it continues. */
static const csp_place overwritten = {
    .waiting = CSP_AT_OVERWRITTEN, .failed = 0xFFFFU, .where = "overwritten state"};

const csp_place *csp_place_of(const csp_process *process)
{
    const csp_class *const kind = process->kind;
    const csp_place *place = &overwritten;
    if ((process->party.state < kind->states) || (kind->states == 0U)) {
        place = &kind->places[process->party.state];
    }
    return (place->where != NULL) ? place : &overwritten;
}

void *csp_object_at(const csp_process *process, const csp_place *place)
{
    const char *const at = (const char *)process + way_to(process, place->offset, place->stride);
    void *object = NULL;
    if (place->indirect) {
        (void)memcpy(&object, at, sizeof(object));
    } else {
        (void)memcpy(&object, &at, sizeof(object));
    }
    return object;
}

csp_progress csp_raise(csp_kernel *csp, csp_party *party, uint16_t exception, const char *place)
{
    csp_observe_loop(csp, NULL);
    clear_error(csp);
    csp->error.exception = exception;
    csp->error.place = place;
    csp->error.process = (const csp_process *)(const void *)party;
    return CSP_FAILS;
}

csp_progress csp_raise_fault(csp_kernel *csp, csp_party *party)
{
    (void)csp_raise(csp, party, (uint16_t)CSP_FAULT_EXCEPTION, csp->fault.place);
    csp->error.describe = csp->fault.describe;
    csp->error.operands = csp->fault.operands;
    csp->error.law = csp->fault.law;
    csp->fault.describe = NULL;
    return CSP_FAILS;
}

void csp_raise_noted_fault(csp_kernel *csp, csp_party *party, const char *part, const char *place)
{
    if (part != NULL) {
        csp->fault.law = part;
    }
    (void)csp_fault_at(csp, place);
    (void)csp_raise_fault(csp, party);
}

csp_progress csp_refuse(csp_kernel *csp, const csp_party *party)
{
    (void)party;
    csp_observe_loop(csp, NULL);
    clear_error(csp);
    csp->error.exception = CSP_CANCELLATION;
    return CSP_FAILS;
}

void csp_unwind(csp_kernel *csp, csp_party *party)
{
    if ((party->flags & (unsigned)CSP_ABANDONED) != 0U) {
        party->flags &= (uint8_t)~(unsigned)CSP_ABANDONED;
        (void)csp_refuse(csp, party);
    } else if ((csp->error.process == NULL) && (csp->error.exception != (uint16_t)CSP_CANCELLATION)) {
        csp->error.process = (const csp_process *)(const void *)party;
    } else {
        /* `csp->error` is already complete. */
    }
    if ((csp->error.place == NULL) && (csp->error.process == (const csp_process *)(const void *)party)) {
        csp->error.place = csp_place_of(csp->error.process)->where;
        csp->error.inner = csp_place_of(csp->error.process)->inner;
    }
}

bool csp_catch(csp_kernel *csp, uint16_t exception)
{
    if (csp->error.exception != exception) {
        return false;
    }
    clear_error(csp);
    return true;
}

void csp_require_written(csp_kernel *csp, const csp_written *written)
{
    if ((written != NULL) && !written->done) {
        const char *const *const names = csp->program->variable_names;
        csp_not_written(csp, (names != NULL) ? names[written->number] : "a variable");
    }
}

csp_party *csp_call(csp_party *party, csp_process *callee)
{
    callee->above = party;
    callee->party.state = 0U;
    callee->party.flags = (uint8_t)(party->flags & (unsigned)CSP_CANCELLED);
    callee->party.level = party->level;
    return &callee->party;
}

csp_process *csp_next_branch(csp_parallel *parallel)
{
    while (parallel->run < parallel->runs) {
        const csp_branches *const branches = &parallel->branches[parallel->run];
        if (parallel->index < branches->count) {
            char *const at = (char *)parallel->parent + way_to(parallel->parent, branches->offset, branches->parent_stride);
            csp_process *const branch =
                (csp_process *)(void *)(at + ((size_t)parallel->index * branches->stride));
            parallel->index++;
            return branch;
        }
        parallel->run++;
        parallel->index = 0U;
    }
    return NULL;
}

#if CSP_USES_BRANCHES
static inline void branch_ended(csp_kernel *csp, csp_parallel *parallel, bool cancelled)
{
    parallel->pending--;
    if (parallel->pending == 0U) {
        csp_ready(csp, &parallel->parent->party);
    }
#if CSP_USES_INTERRUPTS
    if (parallel->interrupt != NULL) {
        csp_body_ended(csp, parallel->interrupt, cancelled);
    }
#else
    (void)cancelled;
#endif
}

/* The first exception of a branch cancels the other branches, and is raised by the parallel. */
static void branch_failed(csp_kernel *csp, csp_parallel *parallel)
{
    const bool cancelled = csp->error.exception == (uint16_t)CSP_CANCELLATION;
    if (cancelled) {
        parallel->cancelled = true;
    } else if (parallel->error.exception == (uint16_t)CSP_NO_EXCEPTION) {
        parallel->error = csp->error;
        parallel->run = 0U;
        parallel->index = 0U;
        csp_process *branch = csp_next_branch(parallel);
        while (branch != NULL) {
            csp_cancel(csp, branch, NULL);
            branch = csp_next_branch(parallel);
        }
    } else {
        /* A later exception is ignored. */
    }
    branch_ended(csp, parallel, cancelled);
}
#endif

csp_party *csp_end(csp_kernel *csp, csp_party *party)
{
    const csp_process *const process = (const csp_process *)(const void *)party;
    const unsigned flags = party->flags;
    party->flags = (uint8_t)(flags | (unsigned)CSP_ENDED);
#if CSP_USES_BRANCHES
    if ((flags & (unsigned)CSP_BRANCH) != 0U) {
        branch_ended(csp, (csp_parallel *)process->above, false);
        return NULL;
    }
#endif
    if (process->above == NULL) {
        clear_error(csp);
    }
    return (csp_party *)process->above;
}

csp_party *csp_fail(csp_kernel *csp, csp_party *party)
{
    const csp_process *const process = (const csp_process *)(const void *)party;
    const unsigned flags = party->flags;
    party->flags = (uint8_t)(flags | (unsigned)CSP_ENDED);
#if CSP_USES_BRANCHES
    if ((flags & (unsigned)CSP_BRANCH) != 0U) {
        branch_failed(csp, (csp_parallel *)process->above);
        return NULL;
    }
#else
    (void)csp;
#endif
    if (process->above != NULL) {
        csp_process *const caller = (csp_process *)process->above;
        caller->party.state = csp_place_of(caller)->failed;
    }
    return (csp_party *)process->above;
}

csp_party *csp_overwritten(csp_kernel *csp, csp_party *party)
{
    (void)csp_raise(csp, party, (uint16_t)CSP_FAULT_EXCEPTION, overwritten.where);
    csp_outermost(csp)->party.flags = (uint8_t)CSP_ENDED;
    for (uint32_t level = 0U; level < CSP_LEVELS; level++) {
        csp->ready[level].first = NULL;
    }
    return NULL;
}

csp_progress csp_par(csp_kernel *csp, csp_party *party, csp_parallel *parallel, const csp_branches *branches, uint32_t runs)
{
    if (csp_is_cancelled(party)) {
        return csp_refuse(csp, party);
    }
    csp_process *const parent = (csp_process *)(void *)party;
    uint32_t pending = 0U;
    parallel->parent = parent;
    parallel->interrupt = NULL;
    parallel->branches = branches;
    parallel->runs = runs;
    parallel->abandoned = false;
    parallel->cancelled = false;
    parallel->error.exception = (uint16_t)CSP_NO_EXCEPTION;
    for (uint32_t run = 0U; run < runs; run++) {
        char *at = (char *)parent + way_to(parent, branches[run].offset, branches[run].parent_stride);
        const uint8_t level = (uint8_t)(party->level + branches[run].level);
        for (uint32_t index = 0U; index < branches[run].count; index++) {
            csp_process *const branch = (csp_process *)(void *)at;
            branch->above = parallel;
            branch->party.state = 0U;
            branch->party.flags = (uint8_t)CSP_BRANCH;
            branch->party.level = level;
            csp_ready(csp, &branch->party);
            at += branches[run].stride;
        }
        pending += branches[run].count;
    }
    parallel->pending = pending;
    return (pending == 0U) ? CSP_DONE : CSP_WAITS;
}

csp_progress csp_par_again(csp_kernel *csp, csp_party *party, csp_parallel *parallel)
{
    if (parallel->error.exception != (uint16_t)CSP_NO_EXCEPTION) {
        csp->error = parallel->error;
        return CSP_FAILS;
    }
    if (parallel->abandoned && parallel->cancelled) {
        return csp_refuse(csp, party);
    }
    return CSP_DONE;
}
