/* An alternative with more guards than a word has bits: fair over all of them, with and without some enabled. */
#include "script.h"

enum { GUARDS = 130 };

static script scripts[GUARDS + 2];
static csp_guarded_channel channel[GUARDS];
static csp_alternative choice;
static csp_guard guards[GUARDS];
static csp_word words[2U * CSP_WORDS(GUARDS)];
static const char *names[GUARDS];
static char texts[GUARDS][8];
static script_list writing[GUARDS];
static const csp_branches branches[] = {{sizeof(script), sizeof(script), GUARDS + 1U, 0U, 0U}};
static const script_list top = {{.action = PARALLEL, .branches = branches, .branch_runs = 1U}};

/* What script_step_function would do for a list with GUARDS continuations: chooses until all enabled guards have been chosen. */
static csp_party *chooser_step(csp_kernel *csp, csp_party *party)
{
    script *const self = (script *)(void *)party;
    csp_progress progress = CSP_DONE;
    switch (party->state) {
    case 0:
        csp_enable_none(&choice);
        for (uint16_t index = 0U; index < (uint16_t)GUARDS; index++) {
            if ((index % 3U) == 0U) {
                csp_enable(&choice, index);
            }
        }
        for (self->repeated = 0; self->repeated < 7; self->repeated++) {
            CSP_AWAIT(csp_select(csp, party, &choice), csp_select_again(csp, party, &choice), 1, failed)
        }
        csp_enable_all(&choice);
        for (self->repeated = 0; self->repeated < 7; self->repeated++) {
            CSP_AWAIT(csp_select_inputs(csp, party, &choice, GUARDS), csp_select_again(csp, party, &choice), 2, failed)
        }
        return csp_end(csp, party);
    case 3:
    failed:
        csp_unwind(csp, party);
        return csp_fail(csp, party);
    default:
        return NULL;
    }
}

static const csp_place places[] = {
    {CSP_AT_NOTHING, false, 3U, 0U, 0U, "test.csp:1", NULL},
    {CSP_AT_STOP, false, 3U, 0U, 0U, "test.csp:1", NULL},
    {CSP_AT_STOP, false, 3U, 0U, 0U, "test.csp:1", NULL},
    {CSP_AT_NOTHING, false, 3U, 0U, 0U, "test.csp:1", NULL},
};
static const csp_class chooser_class = {chooser_step, places, "chooser", "test.csp:1", 0U, 0U, 0U};

int main(void)
{
    script_init(&scripts[0], 1U, "Top", top);
    csp_alternative_init(&choice, guards, GUARDS, words, false);
    for (uint16_t index = 0U; index < (uint16_t)GUARDS; index++) {
        static const char digits[] = "0123456789";
        char *const text = texts[index];
        text[0] = 'c';
        text[1] = digits[index / 100U];
        text[2] = digits[(index / 10U) % 10U];
        text[3] = digits[index % 10U];
        names[index] = text;
        csp_guarded_init(&channel[index], index);
        csp_guard_read(&choice, index, &channel[index].channel.medium, &scripts[GUARDS + 1].value, sizeof(int64_t));
        /* Some arrive late, and all but every seventh never do. */
        writing[index][0].action = DELAY;
        writing[index][0].value = ((index % 2U) == 0U) ? 0 : (GUARDS - index);
        writing[index][1].action = ((index % 7U) == 0U) ? WRITE : STOP;
        writing[index][1].medium = &channel[index].channel.medium;
        writing[index][1].value = index + 1;
        script_init(&scripts[index + 1U], index + 2U, text, writing[index]);
    }
    csp_process_init(&scripts[GUARDS + 1].process, &chooser_class, GUARDS + 2U);
    scripts[GUARDS + 1].name = "chooser";
    script_run(scripts, names, NULL, 0U, NULL, 120 * INT64_C(1000000));
    return 0;
}
