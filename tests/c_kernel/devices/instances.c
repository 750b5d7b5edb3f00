/* Several instances of devices/machine.csp in one process, each with devices of its own: one alone, two whose steps alternate, and two in threads.
 * Each drive must get the same values in all cases. */
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>

#include "network.h"

#define MS INT64_C(1000000)

enum { TICKS = 400, STEPS = 3 };

struct plant {
    struct network network;
    double gain;
    int sampled;
    int released;
    double driven[TICKS];
    int count;
    bool lamp;
    int64_t pressed_at;
};

static bool read_level(void *device, void *value)
{
    struct plant *const plant = device;
    plant->sampled++;
    *(double *)value = plant->gain * plant->sampled;
    return true;
}

static void write_drive(void *device, const void *value)
{
    struct plant *const plant = device;
    if (*(const double *)value < 0.0) {
        plant->released++;
    } else {
        plant->driven[plant->count] = *(const double *)value;
        plant->count++;
    }
}

static void write_lamp(void *device, const void *value)
{
    struct plant *const plant = device;
    plant->lamp = plant->lamp || *(const bool *)value;
}

static void begin(struct plant *plant, double gain, int64_t pressed_at)
{
    const struct network_drivers drivers = {
        .level = {.device = plant, .read = read_level},
        .drive = {.device = plant, .write = write_drive},
        .lamp = {.device = plant, .write = write_lamp},
    };
    (void)memset(plant, 0, sizeof *plant);
    plant->gain = gain;
    plant->pressed_at = pressed_at;
    network_initialize(&plant->network, &drivers, NULL);
    if (csp_begin(&plant->network.kernel) != CSP_MORE) {
        exit(1);
    }
}

static csp_ending advance(struct plant *plant, int64_t until)
{
    csp_ending ending = CSP_BUDGET;
    if (until == plant->pressed_at) {
        (void)network_bring_button(&plant->network, true);
    }
    while (ending == CSP_BUDGET) {
        ending = csp_advance(&plant->network.kernel, until, STEPS);
    }
    return ending;
}

static void show(struct plant *plant, csp_ending ending)
{
    double sum = 0.0;
    for (int index = 0; index < plant->count; index++) {
        sum += plant->driven[index];
    }
    csp_finish(&plant->network.kernel);
    (void)printf("%d: %d driven, sum %g, lamp %d, released %d\n", (int)ending, plant->count, sum, plant->lamp,
                 plant->released);
}

static void *run_alone(void *argument)
{
    struct plant *const plant = argument;
    csp_ending ending = CSP_MORE;
    for (int64_t now = 0; (now <= 300 * MS) && (ending == CSP_MORE); now += MS) {
        ending = advance(plant, now);
    }
    plant->sampled = (int)ending;
    return NULL;
}

int main(void)
{
    static struct plant one;
    static struct plant other;
    csp_ending first = CSP_MORE;
    csp_ending second = CSP_MORE;
    pthread_t threads[2];
    begin(&one, 0.5, 101 * MS);
    (void)run_alone(&one);
    show(&one, (csp_ending)one.sampled);
    begin(&other, 2.0, 200 * MS);
    (void)run_alone(&other);
    show(&other, (csp_ending)other.sampled);

    begin(&one, 0.5, 101 * MS);
    begin(&other, 2.0, 200 * MS);
    for (int64_t now = 0; now <= 300 * MS; now += MS) {
        first = advance(&one, now);
        second = advance(&other, now);
    }
    show(&one, first);
    show(&other, second);

    begin(&one, 0.5, 101 * MS);
    begin(&other, 2.0, 200 * MS);
    (void)pthread_create(&threads[0], NULL, run_alone, &one);
    (void)pthread_create(&threads[1], NULL, run_alone, &other);
    (void)pthread_join(threads[0], NULL);
    (void)pthread_join(threads[1], NULL);
    show(&one, (csp_ending)one.sampled);
    show(&other, (csp_ending)other.sampled);
    return 0;
}
