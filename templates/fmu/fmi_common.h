/* The functions that FMI 2.0 and 3.0 have in common. The file that includes this says, as macros, how its version writes names:
 * FMI(name), FMI_STATE(before, after) around its word for states, FMI_TEXT(name) as a text; and its type for truth, FMI_BOOLEAN.
 */
enum {
    INSTANTIATED = 1 << FMU_INSTANTIATED,
    INITIALIZING = 1 << FMU_INITIALIZING,
    STEPPING = 1 << FMU_STEPPING,
    IN_EVENT = 1 << FMU_IN_EVENT, /* never with FMI 2.0 */
    TERMINATED = 1 << FMU_TERMINATED,
    FAILED = 1 << FMU_FAILED,
    READABLE = INITIALIZING | STEPPING | IN_EVENT | TERMINATED | FAILED,
    ANY = INSTANTIATED | READABLE
};

static FMI(Status) status_of(bool done)
{
    return done ? FMI(OK) : FMI(Error);
}

/* ---- Life ---- */

FMU_EXPORT FMI(Status) FMI(SetDebugLogging)(void *c, FMI_BOOLEAN on, size_t count, const char *const categories[])
{
    fmu_instance *const self = c;
    self->logs_events = on && (count == 0U);
    for (size_t index = 0U; on && (index < count); index++) {
        self->logs_events = self->logs_events || (strcmp(categories[index], "logEvents") == 0);
    }
    return FMI(OK);
}

FMU_EXPORT void FMI(FreeInstance)(void *c)
{
    fmu_free(c);
}

FMU_EXPORT FMI(Status) FMI(ExitInitializationMode)(void *c)
{
    return status_of(fmu_is_allowed(c, INITIALIZING, FMI_TEXT(ExitInitializationMode)) && fmu_initialized(c));
}

FMU_EXPORT FMI(Status) FMI(Terminate)(void *c)
{
    return status_of(fmu_is_allowed(c, STEPPING | IN_EVENT | FAILED, FMI_TEXT(Terminate)) && fmu_terminate(c));
}

FMU_EXPORT FMI(Status) FMI(Reset)(void *c)
{
    return status_of(fmu_reset(c));
}

/* ---- States ---- */

FMU_EXPORT FMI(Status) FMI_STATE(Get, )(void *c, void **state)
{
    if (state == NULL) {
        return FMI(Error);
    }
    *state = fmu_get_state(c, *state);
    return status_of(*state != NULL);
}

FMU_EXPORT FMI(Status) FMI_STATE(Set, )(void *c, void *state)
{
    return status_of(fmu_set_state(c, state));
}

FMU_EXPORT FMI(Status) FMI_STATE(Free, )(void *c, void **state)
{
    (void)c;
    if (state != NULL) {
        fmu_free_state(*state);
        *state = NULL;
    }
    return FMI(OK);
}

FMU_EXPORT FMI(Status) FMI_STATE(Serialized, Size)(void *c, void *state, size_t *size)
{
    (void)c;
    (void)state;
    *size = fmu_state_size();
    return FMI(OK);
}

FMU_EXPORT FMI(Status) FMI_STATE(Serialize, )(void *c, void *state, unsigned char bytes[], size_t size)
{
    return status_of(fmu_write_state(c, state, bytes, size));
}

FMU_EXPORT FMI(Status) FMI_STATE(FMI_READ, )(void *c, const unsigned char bytes[], size_t size, void **state)
{
    *state = fmu_read_state(c, bytes, size);
    return status_of(*state != NULL);
}
