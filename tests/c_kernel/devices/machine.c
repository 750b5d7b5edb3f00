/* The machine with the devices of a test: the argument says what they do wrong. Reports use only `write`, which signal handlers may
 * call. */
#define _XOPEN_SOURCE 700

#include <pthread.h>
#include <signal.h>
#include <stdlib.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

#include "csp_internal.h"
#include "csp_port.h"
#include "csp_shared.h"
#include "csp_signals.h"
#include "network.h"

enum { NUMBER = 24 };

static const char *trouble;
static struct network network;
static int polled;
static volatile int sampled;
static volatile int turns;
static volatile bool released;
static volatile uintptr_t zero;

static bool is(const char *name)
{
    return strcmp(trouble, name) == 0;
}

/* Whether the name is part of it. */
static bool has(const char *name)
{
    return strstr(trouble, name) != NULL;
}

static void say(const char *word, long number)
{
    char digits[NUMBER];
    char text[2 * NUMBER] = "";
    long rest = (number < 0) ? -number : number;
    size_t at = sizeof digits - 1U;
    digits[at] = '\0';
    do {
        at--;
        digits[at] = "0123456789"[rest % 10];
        rest /= 10;
    } while (rest > 0);
    (void)strcat(strcat(strcat(strcat(text, word), (number < 0) ? " -" : " "), &digits[at]), "\n");
    if (write(STDOUT_FILENO, text, strlen(text)) < 0) {
        _exit(EXIT_FAILURE);
    }
}

void csp_port_alive(void)
{
    turns++;
}

static void pass(long milliseconds)
{
    const struct timespec duration = {milliseconds / 1000, (milliseconds % 1000) * 1000000};
    (void)nanosleep(&duration, NULL);
}

static void hang(void)
{
    for (;;) {
        pass(1000);
    }
}

static int overflow(int depth)
{
    volatile char frame[4096];
    frame[0] = (char)depth;
    return (depth < 0) ? frame[0] : (overflow(depth + 1) + frame[0]);
}

static void *make_trouble(void *nothing)
{
    while (CSP_LOAD(sampled) < 5) {
        pass(1);
    }
    if (has("exits")) {
        exit(7);
    } else if (has("crashes")) {
        *(volatile int *)zero = 1;
    } else if (has("aborts")) {
        abort();
    } else {
        /* It ends. */
    }
    return nothing;
}

/* One child ends by a signal, one by itself; neither has outputs. */
static void have_children(void)
{
    int status = 0;
    pid_t child = fork();
    if (child == 0) {
        (void)raise(SIGTERM);
    }
    (void)waitpid(child, &status, 0);
    say("child ended by signal", WIFSIGNALED(status) ? WTERMSIG(status) : 0);
    child = fork();
    if (child == 0) {
        exit(3);
    }
    (void)waitpid(child, &status, 0);
    say("child ended with", WIFEXITED(status) ? WEXITSTATUS(status) : -1);
}

static void press(int number)
{
    (void)number;
    (void)network_bring_button(&network, true);
}

static void *press_later(void *nothing)
{
    pass(20);
    (void)network_bring_button(&network, true);
    return nothing;
}

static bool read_button(void *device, void *value)
{
    (void)device;
    polled++;
    *(bool *)value = true;
    return has("polled") && (polled == 10);
}

static bool read_level(void *device, void *value)
{
    (void)device;
    (void)CSP_COUNT(sampled);
    *(double *)value = 3.0;
    if (sampled == 5) {
        say("drives", 5);
        if (has("read hangs")) {
            hang();
        } else if (is("read spins")) {
            while (csp_port_now() >= 0) {
            }
        } else if (is("segmentation")) {
            *(volatile int *)zero = 1;
        } else if (has("read overflows")) {
            say("deep", overflow(0));
        } else if (is("division")) {
            (void)raise(SIGFPE);
        } else if (is("abort")) {
            abort();
        } else if (is("exit") || is("exit and safe value exits")) {
            exit(7);
        } else if (is("thread ends")) {
            pthread_exit(NULL);
        } else if (is("children")) {
            have_children();
        } else if (is("pressed by a signal")) {
            (void)raise(SIGUSR1);
        } else {
            /* It continues. */
        }
    }
    if (is("slow")) {
        pass(3);
    }
    return true;
}

static void write_drive(void *device, const void *value)
{
    (void)device;
    if (*(const double *)value < 0.0) {
        say("released drive", (long)*(const double *)value);
        released = true;
        if (has("another thread")) {
            pass(100); /* for a thread that continues to write */
        } else if (has("safe value crashes")) {
            *(volatile int *)zero = 1;
        } else if (has("safe value hangs")) {
            hang();
        } else if (has("safe value exits")) {
            exit(9);
        } else if (has("safe value overflows")) {
            say("deep", overflow(0));
        } else {
            /* It is safe. */
        }
    } else if (released) {
        say("drives after the release", 1);
    } else {
        /* As usual. */
    }
}

static void write_lamp(void *device, const void *value)
{
    (void)device;
    say(*(const bool *)value ? "lamp" : "released lamp", (long)*(const bool *)value);
}

/* Nested sections leave everything as it was. */
static void look_at_critical_sections(void)
{
    sigset_t mask;
    const uint32_t outer = csp_port_enter_critical();
    const uint32_t inner = csp_port_enter_critical();
    csp_port_leave_critical(inner);
    (void)pthread_sigmask(SIG_BLOCK, NULL, &mask);
    say("masked in between", sigismember(&mask, SIGUSR1));
    csp_port_leave_critical(outer);
    (void)pthread_sigmask(SIG_BLOCK, NULL, &mask);
    say("masked after", sigismember(&mask, SIGUSR1));
}

static csp_ending run(bool built)
{
    static const struct network_drivers polling = {
        .button = {.read = read_button},
        .level = {.read = read_level},
        .drive = {.write = write_drive},
        .lamp = {.write = write_lamp},
    };
    struct network_drivers drivers = polling;
    if (strncmp(trouble, "pressed", 7U) == 0) {
        drivers.button.read = NULL;
    }
    polled = 0;
    CSP_STORE(sampled, 0);
    if (built) {
        network_initialize(&network, &drivers, csp_port_hooks());
        if (!is("slow")) { /* the machine that runs the test may be late */
            network.external.level.counts = true;
        }
        if (is("pressed by a thread")) { /* events come only after the network is built */
            pthread_t thread;
            (void)pthread_create(&thread, NULL, press_later, NULL);
            (void)pthread_detach(thread);
        }
    }
    const csp_ending ending = csp_run(&network.kernel, has("polled") ? -1 : INT64_C(60000000000));
    say("sampled", sampled);
    say("polled", polled);
    say("ending", (long)ending);
    return ending;
}

static void *run_in_thread(void *ending)
{
    sigset_t all;
    (void)sigfillset(&all);
    if (has("held back")) {
        (void)pthread_sigmask(SIG_BLOCK, &all, NULL);
    }
    *(csp_ending *)ending = run(true);
    return ending;
}

int main(int count, char **arguments)
{
    char text[200] = "";
    pthread_t thread;
    csp_ending ending = CSP_FAILED;
    trouble = (count > 1) ? arguments[1] : "";
    (void)signal(SIGUSR1, press);
    if (is("critical")) {
        look_at_critical_sections();
        return 0;
    }
    if (has("another thread")) {
        (void)pthread_create(&thread, NULL, make_trouble, NULL);
        (void)pthread_detach(thread);
    } else {
        /* There is no other thread. */
    }
    if (has("held back") || is("thread ends")) {
        (void)pthread_create(&thread, NULL, run_in_thread, &ending);
        (void)pthread_join(thread, NULL);
    } else {
        ending = run(true);
    }
    if (is("lingers")) {
        say("lingers", 1);
        pass(100);
    }
    if (count > 2) { /* once more */
        ending = run(arguments[2][0] == 'b');
    }
    if (ending == CSP_FAILED) {
        csp_describe_error(&network.kernel, text, sizeof text);
        (void)strcat(text, "\n");
        (void)!write(STDOUT_FILENO, text, strlen(text));
    }
    say("alive", turns > 5);
    return csp_exit_status(ending);
}
