/* See csp_fmu_library.h: loads a binary, and finds its functions. */
#define _POSIX_C_SOURCE 200809L /* dlopen */
#include "csp_fmu_library.h"

#include <dlfcn.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>

typedef int plain_function(void *c);

bool csp_fmu_fail(csp_fmu *self, const char *format, ...)
{
    struct csp_fmu_library *const library = self->library;
    char text[CSP_FMU_TEXT] = "";
    va_list arguments;
    va_start(arguments, format);
    (void)vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (library->failure[0] == '\0') {
        const bool has_message = library->message[0] != '\0';
        (void)snprintf(library->failure, sizeof library->failure, "%s %s%s%s", self->facts->name, text, has_message ? ": " : "",
                       library->message);
    }
    return false;
}

bool csp_fmu_has_ended(csp_fmu *self, double time)
{
    return csp_fmu_fail(self, "has ended the simulation at %.9g s", time);
}

void *csp_fmu_find(const csp_fmu *self, const char *action, const char *name)
{
    char text[80] = "";
    (void)snprintf(text, sizeof text, "fmi%d%s%s", self->facts->is_new ? 3 : 2, action, name);
    return dlsym(self->library->handle, text);
}

void *csp_fmu_function(csp_fmu *self, const char *name)
{
    struct csp_fmu_library *const library = self->library;
    size_t index = 0U;
    while ((index < (CSP_FMU_KNOWN - 1U)) && (library->known[index].name != NULL)) {
        if (library->known[index].name == name) {
            return library->known[index].function;
        }
        index++;
    }
    library->known[index].name = name;
    library->known[index].function = csp_fmu_find(self, name, "");
    return library->known[index].function;
}

bool csp_fmu_is_fine(csp_fmu *self, int status, const char *function, double time)
{
    static const char *const words[] = {"", "", "discard", "an error", "a fatal error"};
    if (status < (int)CSP_FMU_DISCARD) {
        self->library->message[0] = '\0';
        return true;
    }
    return csp_fmu_fail(self, "returned %s in fmi%d%s, at %.9g s", words[(status < 5) ? status : 3], self->facts->is_new ? 3 : 2,
                function, time);
}

bool csp_fmu_call(csp_fmu *self, const char *function, double time)
{
    plain_function *found = NULL;
    *(void **)&found = csp_fmu_function(self, function);
    return (found != NULL) ? csp_fmu_is_fine(self, found(self->library->component), function, time)
                           : csp_fmu_fail(self, "has no function %s", function);
}

static void log2_message(void *environment, const char *name, int status, const char *category, const char *message, ...)
{
    struct csp_fmu_library *const library = environment;
    va_list arguments;
    (void)name;
    (void)category;
    if (status != CSP_FMU_OK) {
        va_start(arguments, message);
        (void)vsnprintf(library->message, sizeof library->message, (message != NULL) ? message : "", arguments);
        va_end(arguments);
    }
}

static void log3_message(void *environment, int status, const char *category, const char *message)
{
    struct csp_fmu_library *const library = environment;
    (void)category;
    if (status != CSP_FMU_OK) {
        (void)snprintf(library->message, sizeof library->message, "%s", (message != NULL) ? message : "");
    }
}

/* With messages: there are FMUs that say only then why they fail. */
static bool instantiate2(csp_fmu *self)
{
    void *(*make)(const char *, int, const char *, const char *, const csp_fmu_callbacks *, int, int) = NULL;
    struct csp_fmu_library *const library = self->library;
    const csp_fmu_callbacks functions = {log2_message, calloc, free, NULL, library};
    library->functions = functions;
    *(void **)&make = csp_fmu_function(self, "Instantiate");
    if (make != NULL) {
        library->component = make(self->facts->instance, self->facts->is_model_exchange ? 0 : 1, self->facts->token,
                                  self->facts->resources, &library->functions, 0, 1);
    }
    return (library->component != NULL) || csp_fmu_fail(self, "cannot be instantiated");
}

typedef void log3_function(void *environment, int status, const char *category, const char *message);

static bool instantiate3(csp_fmu *self)
{
    struct csp_fmu_library *const library = self->library;
    const csp_fmu_facts *const facts = self->facts;
    if (facts->is_model_exchange) {
        void *(*make)(const char *, const char *, const char *, bool, bool, void *, log3_function *) = NULL;
        *(void **)&make = csp_fmu_function(self, "InstantiateModelExchange");
        if (make != NULL) {
            library->component = make(facts->instance, facts->token, facts->resources, false, true, library, log3_message);
        }
    } else {
        void *(*make)(const char *, const char *, const char *, bool, bool, bool, bool, const uint32_t *, size_t, void *,
                      log3_function *, void *) = NULL;
        *(void **)&make = csp_fmu_function(self, "InstantiateCoSimulation");
        if (make != NULL) {
            library->component = make(facts->instance, facts->token, facts->resources, false, true, false, false, NULL, 0U,
                                      library, log3_message, NULL);
        }
    }
    return (library->component != NULL) || csp_fmu_fail(self, "cannot be instantiated");
}

static void *room(size_t count, size_t size)
{
    return calloc((count > 0U) ? count : 1U, size);
}

bool csp_fmu_load(csp_fmu *self)
{
    struct csp_fmu_library *const library = self->library;
    const csp_fmu_facts *const facts = self->facts;
    library->handle = dlopen(facts->library, RTLD_NOW | RTLD_LOCAL);
    if (library->handle == NULL) {
        return csp_fmu_fail(self, "cannot be loaded: its binary is damaged, or needs what is not here: %s", dlerror());
    }
    library->getters = room(facts->output_count, sizeof *library->getters);
    library->setters = room(facts->input_count, sizeof *library->setters);
    library->given = room(facts->input_count, sizeof(csp_fmu_value));
    library->x = room(facts->states, sizeof(double));
    library->moved = room(facts->states, sizeof(double));
    for (size_t index = 0U; index < 4U; index++) {
        library->k[index] = room(facts->states, sizeof(double));
    }
    library->indicators = room(facts->indicators, sizeof(double));
    library->before = room(facts->indicators, sizeof(bool));
    library->after = room(facts->indicators, sizeof(bool));
    for (size_t index = 0U; index < facts->output_count; index++) {
        library->getters[index] = csp_fmu_find(self, "Get", facts->outputs[index].functions);
    }
    for (size_t index = 0U; index < facts->input_count; index++) {
        library->setters[index] = csp_fmu_find(self, "Set", facts->inputs[index].functions);
    }
    return facts->is_new ? instantiate3(self) : instantiate2(self);
}

void csp_fmu_unload(struct csp_fmu_library *library, bool is_new)
{
    void (*end)(void *) = NULL;
    if ((library->handle != NULL) && (library->component != NULL)) {
        *(void **)&end = dlsym(library->handle, is_new ? "fmi3FreeInstance" : "fmi2FreeInstance");
        if (end != NULL) {
            end(library->component);
        }
    }
    free(library->getters);
    free(library->setters);
    free(library->given);
    free(library->x);
    free(library->moved);
    for (size_t index = 0U; index < 4U; index++) {
        free(library->k[index]);
    }
    free(library->indicators);
    free(library->before);
    free(library->after);
    free(library);
}
