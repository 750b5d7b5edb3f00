/* Events of devices/counter.csp from a second thread, while the program advances: none is lost without a report.
 * Some of those that were reported were read after all, in the same step. */
#include <pthread.h>
#include <stdio.h>

#include "counter_api.h"

enum { EVENTS = 20000 };

static counter_memory memory;
static pthread_mutex_t mutex = PTHREAD_MUTEX_INITIALIZER;
static int64_t taken;
static int64_t latest;
static bool in_order = true;
static volatile bool sent;

static void actuate(void *context, counter_output output, const counter_outputs *outputs, bool safe)
{
    (void)context;
    (void)output;
    if (!safe) {
        taken++;
        in_order = in_order && (outputs->taken > latest);
        latest = outputs->taken;
    }
}

static uint32_t lock(void *context)
{
    (void)context;
    (void)pthread_mutex_lock(&mutex);
    return 0U;
}

static void unlock(void *context, uint32_t before)
{
    (void)context;
    (void)before;
    (void)pthread_mutex_unlock(&mutex);
}

static void *send(void *argument)
{
    int64_t *const overwritten = argument;
    counter_instance *const self = (counter_instance *)(void *)&memory;
    for (int64_t event = 1; event <= EVENTS; event++) {
        *overwritten += counter_press(self, event) ? 1 : 0;
    }
    __atomic_store_n(&sent, true, __ATOMIC_SEQ_CST);
    return NULL;
}

int main(void)
{
    const counter_hooks hooks = {.actuate = actuate, .lock = lock, .unlock = unlock};
    counter_instance *const self = counter_begin(&memory, sizeof memory, &hooks, NULL);
    int64_t overwritten = 0;
    int64_t now = 0;
    pthread_t thread;
    char text[100] = "";
    (void)pthread_create(&thread, NULL, send, &overwritten);
    while (!__atomic_load_n(&sent, __ATOMIC_SEQ_CST)) {
        now++;
        (void)counter_advance(self, now, 3U);
    }
    (void)pthread_join(thread, NULL);
    counter_state state = counter_advance(self, now, 1000U);
    (void)printf("lost unreported %d, in order %d, last %d, state %d\n", taken + overwritten < EVENTS, in_order,
                 latest == EVENTS, (int)state);
    counter_stop(self);
    state = counter_advance(self, now, 1U);
    counter_describe(self, text, sizeof text);
    (void)printf("%s %d\n", text, (int)state);
    return 0;
}
