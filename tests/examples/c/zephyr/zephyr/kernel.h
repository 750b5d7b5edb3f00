/* What the example uses of Zephyr, as its headers declare it, with ticks of 10 us. */
#ifndef ZEPHYR_KERNEL_H
#define ZEPHYR_KERNEL_H

#include <stddef.h>
#include <stdint.h>
#include <stdio.h>

typedef int64_t k_ticks_t;
typedef struct {
    k_ticks_t ticks;
} k_timeout_t;
typedef void (*k_thread_entry_t)(void *, void *, void *);
struct k_sem {
    unsigned int count;
    unsigned int limit;
};

#define ARG_UNUSED(argument) ((void)(argument))
#define K_FOREVER ((k_timeout_t){-1})
#define K_TIMEOUT_ABS_TICKS(instant) ((k_timeout_t){-2 - (instant)})
#define K_PRIO_COOP(priority) (-16 + (priority))
#define K_SEM_DEFINE(name, initial, most) struct k_sem name = {initial, most}
#define K_THREAD_DEFINE(name, stack, entry, one, two, three, priority, options, delay)                                                       \
    const k_thread_entry_t name##_entry = (entry);                                                                                            \
    const size_t name##_stack = (stack)
#define printk printf

int k_sem_take(struct k_sem *semaphore, k_timeout_t timeout);
void k_sem_give(struct k_sem *semaphore);
int64_t k_uptime_ticks(void);
uint64_t k_ns_to_ticks_ceil64(uint64_t nanoseconds);
uint64_t k_ticks_to_ns_floor64(uint64_t ticks);

#endif
