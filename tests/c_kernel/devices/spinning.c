/* The program of devices/spinning.csp with devices that work. */
#include <unistd.h>

#include "csp_signals.h"
#include "network.h"

static bool read_level(void *device, void *value)
{
    (void)device;
    *(double *)value = 3.0;
    return true;
}

static void write_drive(void *device, const void *value)
{
    (void)device;
    if (*(const double *)value < 0.0) {
        (void)!write(STDOUT_FILENO, "released\n", 9);
    }
}

int main(void)
{
    static const struct network_drivers drivers = {.level = {.read = read_level}, .drive = {.write = write_drive}};
    static struct network network;
    network_initialize(&network, &drivers, csp_port_hooks());
    return csp_exit_status(csp_run(&network.kernel, -1));
}
