/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Decides which messages each role may send. */
#include "message/role.h"

#include <string.h>

#include "engineers.h" /* generated from clients/web/core/session.js: the list of parameters for engineers only */
#include "message/names.h"
#include "message/view_address.h"

const struct name names_role[] = {
    { "nobody", ROLE_NOBODY }, { "renderer", ROLE_RENDERER }, { "standby", ROLE_STANDBY },   { "open", ROLE_OPEN },
    { "viewer", ROLE_VIEWER }, { "operator", ROLE_OPERATOR }, { "engineer", ROLE_ENGINEER }, { NULL, 0 },
};

/* The parameters that only engineers may change, because each combination of values makes the server compute another field
   (interpolated values), and choosing them needs expertise. */
#define BIT(name, bit) | GIVEN_##bit
#define NAME(name, bit) #name,
#define LISTED(name, bit) ", " #name
static const unsigned ENGINEERS = 0 ENGINEERS_PARAMS(BIT);
static const char *const ENGINEERS_NAMES[] = { ENGINEERS_PARAMS(NAME) };

static bool refuse_params(struct message_error *error)
{
    message_refuse(error, "not_allowed", &(ENGINEERS_PARAMS(LISTED))[2], REFUSAL_ROLE_ENGINEER);
    return false;
}

static bool params_allowed(enum role role, const struct params_change *change, struct message_error *error)
{
    bool shared = change->baseline == BASELINE_SET || change->baseline == BASELINE_REMOVE || change->baseline == BASELINE_NOW;
    if (role < ROLE_OPERATOR && shared) {
        message_refuse(error, "not_allowed", "baseline", REFUSAL_ROLE_OPERATOR);
        return false;
    }
    return role >= ROLE_ENGINEER || !(change->given & ENGINEERS) || refuse_params(error);
}

static bool alarm_allowed(enum role role, const struct message *message, struct message_error *error)
{
    bool service = message->alarm.action == ALARM_TAKE_OUT || message->alarm.action == ALARM_PUT_BACK;
    if (role >= (service ? ROLE_ENGINEER : ROLE_OPERATOR))
        return true;
    message_refuse(error, "not_allowed", alarm_event_name((enum alarm_event)message->alarm.action),
                   service ? REFUSAL_ROLE_ENGINEER : REFUSAL_ROLE_OPERATOR);
    return false;
}

bool role_may_send(enum role role, const struct message *message, struct message_error *error)
{
    if (message->type == MESSAGE_PING)
        return true;
    if (role == ROLE_NOBODY) {
        message_refuse(error, "token_needed", NULL, REFUSAL_TOKEN_NEEDED);
        return false;
    }
    if (role_is_node(role)) {
        message_refuse(error, "not_allowed", NULL, REFUSAL_TOKEN_NODE);
        return false;
    }
    if (message->type == MESSAGE_ALARM)
        return alarm_allowed(role, message, error);
    if (message->type == MESSAGE_DISPLAY && role < ROLE_VIEWER) {
        message_refuse(error, "not_allowed", NULL, REFUSAL_DISPLAY_TOKEN);
        return false;
    }
    if (message->type == MESSAGE_SHARE_VIEW && role < ROLE_VIEWER) {
        message_refuse(error, "not_allowed", NULL, REFUSAL_TOKEN_NEEDED);
        return false;
    }
    if (message->signed_frames && role < ROLE_VIEWER) {
        message_refuse(error, "not_allowed", "signed", REFUSAL_SIGNED_TOKEN);
        return false;
    }
    bool saves = message->type == MESSAGE_SAVE_TAGS || message->type == MESSAGE_ACCEPT_PLACES || message->type == MESSAGE_RESTORE_TAGS;
    bool engineers = saves || message->type == MESSAGE_PLACE || message->type == MESSAGE_COVERAGE || message->type == MESSAGE_LOOP_CHECK;
    if (engineers && role < ROLE_ENGINEER) {
        message_refuse(error, "not_allowed", "to place sensors or check loops", REFUSAL_ROLE_ENGINEER);
        return false;
    }
    if ((message->type == MESSAGE_PAIR || message->type == MESSAGE_UNPAIR) && role < ROLE_ENGINEER) {
        message_refuse(error, "not_allowed", "to pair or unpair a display", REFUSAL_ROLE_ENGINEER);
        return false;
    }
    const char *operators = message->type == MESSAGE_SAVE_VIEW || message->type == MESSAGE_REMOVE_VIEW ? "to save or remove views"
                            : message->type == MESSAGE_NOTE || message->type == MESSAGE_REMOVE_NOTE    ? "to write or remove notes"
                            : message->type == MESSAGE_SEND_TO_WALL || message->type == MESSAGE_POINT
                                ? "to send views or a pointer to a wall"
                                : NULL;
    if (operators && role < ROLE_OPERATOR) {
        message_refuse(error, "not_allowed", operators, REFUSAL_ROLE_OPERATOR);
        return false;
    }
    if (message->type != MESSAGE_PARAMS && !message->hello.has_params)
        return true;
    return params_allowed(role, &message->params, error) && params_allowed(role, &message->split.right, error);
}

/* Returns true if a query's argument NAME=VALUE, or one of several separated by `;`, sets a parameter that only engineers may change. */
static bool is_for_engineers(const char *arg)
{
    for (size_t i = 0; i < sizeof(ENGINEERS_NAMES) / sizeof(ENGINEERS_NAMES[0]); i++)
        if (view_address_is_named(arg, ENGINEERS_NAMES[i]))
            return true;
    const char *next = strchr(arg, ';');
    return next && is_for_engineers(next + 1);
}

bool role_may_ask(enum role role, const char *arg, struct message_error *error)
{
    const char *first = arg + (strncmp(arg, "split=", 6) ? 0 : 6);
    return role >= ROLE_ENGINEER || !is_for_engineers(first) || refuse_params(error);
}

bool role_may_save(enum role role, const char *address, struct message_error *error)
{
    struct view_address fields;
    struct message_error wrong;
    bool good = true;
    /* if the view's address cannot be parsed, any role may save it, because the server never draws a picture for such an
       address */
    if (view_address_read(&fields, address, &wrong))
        for (size_t i = 0; i < fields.count && good; i++)
            good = role_may_ask(role, fields.args[i], error);
    view_address_finish(&fields);
    return good;
}

const struct plant *role_plant(enum role role, const struct plant *plant, struct plant *copy)
{
    if (role >= ROLE_VIEWER)
        return plant;
    *copy = *plant;
    copy->tag_count = 0;
    return copy;
}

bool message_is_handed_on(const struct message *message)
{
    switch (message->type) {
    case MESSAGE_ALARM:
    case MESSAGE_SAVE_VIEW:
    case MESSAGE_REMOVE_VIEW:
    case MESSAGE_SHARE_VIEW:
    case MESSAGE_NOTE:
    case MESSAGE_REMOVE_NOTE:
    case MESSAGE_SEND_TO_WALL:
    case MESSAGE_PAIR:
    case MESSAGE_UNPAIR:
    case MESSAGE_POINT: return true;
    default: return false;
    }
}
