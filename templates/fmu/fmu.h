/* What an FMU is made of: a model, which is generated, below the functions of FMI 2.0 or 3.0.
 *
 * Times are nanoseconds since the start of the model.
 */
#ifndef FMU_H
#define FMU_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#ifdef _WIN32
#define FMU_EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define FMU_EXPORT __attribute__((visibility("default")))
#else
#define FMU_EXPORT
#endif

enum { FMU_TEXT = 2048 /* the longest message, with its terminating 0 */ };

#define FMU_NANOSECONDS 1e9 /* in a second */

/* ---- The model ---- */

typedef enum fmu_type {
    FMU_FLOAT64,
    FMU_FLOAT32,
    FMU_INT8,
    FMU_UINT8,
    FMU_INT16,
    FMU_UINT16,
    FMU_INT32,
    FMU_UINT32,
    FMU_INT64,
    FMU_BOOLEAN,
    FMU_ENUMERATION, /* an enum of C, whose literals count from 0; in FMI they count from 1 */
    FMU_TIME,        /* int64_t in nanoseconds; in FMI a real number in seconds */
    FMU_CLOCK        /* a bool: active or not */
} fmu_type;

typedef enum fmu_use { FMU_INDEPENDENT, FMU_INPUT, FMU_OUTPUT, FMU_PARAMETER, FMU_FIXED } fmu_use;

/* A fixed parameter may be set until the initialization ends, any other one also between two steps. */

/* A variable; its value reference is its position in the table. The first one is the time. */
typedef struct fmu_variable {
    const char *name;
    fmu_use use;
    fmu_type type;
    size_t offset;    /* from the beginning of the model */
    int64_t literals; /* of an enumeration */
} fmu_variable;

extern const fmu_variable fmu_variables[];
extern const uint32_t fmu_variable_count;

/* What identifies the FMU: its guid, or instantiation token. */
extern const char fmu_token[];

/* Whether a step should end at the next instant of the model, so that inputs are new for it. */
extern const bool fmu_takes_samples;

typedef struct fmu_model fmu_model;

/* Memory for a model, whose inputs have their start values; NULL: there is none left. */
fmu_model *fmu_create(void);

/* Begins at time 0 with the inputs as they are; also to begin again. False: it has failed. */
bool fmu_begin(fmu_model *model);

/* Goes to an instant, for which inputs are not known yet. False: it has failed. */
bool fmu_advance(fmu_model *model, int64_t until);

/* Does what is left to do at the instant that it has reached, with the inputs as they are. False: it has failed. */
bool fmu_meet(fmu_model *model, int64_t now);

/* The next instant at which something is due; INT64_MAX: none. */
int64_t fmu_next(fmu_model *model);

/* Whether it has ended by itself. */
bool fmu_has_ended(const fmu_model *model);

/* Whether clocks of outputs are active, because these events have occurred, and how they become inactive. */
bool fmu_has_events(const fmu_model *model);
void fmu_clear_events(fmu_model *model);

/* Ends the run; outputs get their safe values. */
void fmu_finish(fmu_model *model);

/* What has happened, in words. */
void fmu_describe(fmu_model *model, char *text, size_t size);

/* The state: bytes that mean the same in another instance of the same FMU. Restoring is refused (false) for others. */
extern const size_t fmu_saved_size;
void fmu_save(const fmu_model *model, void *saved);
bool fmu_restore(fmu_model *model, const void *saved);

/* ---- An instance, for both versions of FMI ---- */

typedef enum fmu_phase { FMU_INSTANTIATED, FMU_INITIALIZING, FMU_STEPPING, FMU_IN_EVENT, FMU_TERMINATED, FMU_FAILED } fmu_phase;

typedef enum fmu_severity { FMU_EVENT_MESSAGE, FMU_ERROR_MESSAGE } fmu_severity;

typedef struct fmu_instance fmu_instance;

/* Passes a message to the logger of the simulator. */
typedef void fmu_logger(const fmu_instance *self, fmu_severity severity, const char *text);

struct fmu_instance {
    fmu_model *model;
    fmu_phase phase;
    bool said_end;
    bool logs_events;
    double start; /* the time of the simulator at which the model starts, in seconds */
    int64_t now;
    char *name;
    fmu_logger *logger;
    void (*log)(void); /* the function of the simulator */
    void *environment;
    bool has_event_mode;
    bool may_return_early;
};

/* A new instance, or NULL, after a message, if the token is that of another FMU. */
fmu_instance *fmu_instantiate(const fmu_instance *described, const char *name, const char *token);
void fmu_free(fmu_instance *self);

/* Reports an error: writes the message, and returns false. */
bool fmu_fail(fmu_instance *self, const char *message);

/* Whether a function may be called in the present phase, which is one of `phases` (a sum of 1 << phase); if not, it says so. */
bool fmu_is_allowed(fmu_instance *self, unsigned phases, const char *function);

bool fmu_initialize(fmu_instance *self, double start);
bool fmu_initialized(fmu_instance *self);
bool fmu_reset(fmu_instance *self);
bool fmu_terminate(fmu_instance *self);

/* A step of `length` seconds from `time`. With `stops` it may end earlier, at the next instant of the model. */
bool fmu_step(fmu_instance *self, double time, double length, bool stops);

/* The time of the simulator that has been reached, in seconds, and of another instant. */
double fmu_time(const fmu_instance *self);
double fmu_time_of(const fmu_instance *self, int64_t instant);

/* The instant is done, in event mode. */
bool fmu_update(fmu_instance *self);

/* Values by value reference. */
bool fmu_get_real(fmu_instance *self, uint32_t reference, double *value);
bool fmu_set_real(fmu_instance *self, uint32_t reference, double value);
bool fmu_get_integer(fmu_instance *self, uint32_t reference, int64_t *value);
bool fmu_set_integer(fmu_instance *self, uint32_t reference, int64_t value);
bool fmu_get_boolean(fmu_instance *self, uint32_t reference, bool *value);
bool fmu_set_boolean(fmu_instance *self, uint32_t reference, bool value);

/* The type of a variable; says so and returns false if there is none of this reference. */
bool fmu_type_of(fmu_instance *self, uint32_t reference, fmu_type *type);

/* A copy of the state, which fmu_free_state frees; NULL: there is no memory. */
typedef struct fmu_state fmu_state;
fmu_state *fmu_get_state(fmu_instance *self, fmu_state *into);
bool fmu_set_state(fmu_instance *self, const fmu_state *state);
void fmu_free_state(fmu_state *state);
size_t fmu_state_size(void);
bool fmu_write_state(fmu_instance *self, const fmu_state *state, unsigned char *bytes, size_t size);
fmu_state *fmu_read_state(fmu_instance *self, const unsigned char *bytes, size_t size);

#endif
