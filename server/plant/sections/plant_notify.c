/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads the plant file's `notify`: recipients of alarms and the rules that select them. */
#include "plant/sections/notification.h"

#include <stdio.h>
#include <string.h>

#include "base/mem.h"
#include "plant/plant_impl.h"
#include "plant/sources/url.h"

enum { MIN_PER_DAY = 24 * 60, DAYS = 7, ALL_DAYS = (1 << DAYS) - 1 };

/* --- mail addresses --------------------------------------------------------------------------------------------------------- */

/* Returns whether the text is a mail address that needs no quoting in a header line. */
static bool is_mail_address(const char *text)
{
    const char *at = strchr(text, '@');
    if (!at || at == text || !at[1] || strchr(at + 1, '@') || strlen(text) > 254)
        return false;
    for (; *text; text++)
        if ((unsigned char)*text <= ' ' || (unsigned char)*text >= 127 || strchr("<>()[],;:\\\"", *text))
            return false;
    return true;
}

static void check_mail_address(struct yaml_reader *reader, struct text_position place, const char *name, const char *text)
{
    if (!is_mail_address(text))
        yaml_error(reader, place, "%s: expected an address such as control-room@example.org, found '%.100s'", name, text);
}

/* --- lists of texts --------------------------------------------------------------------------------------------------------- */

/* Reads a key's value that is one text or a list of texts. */
static void read_texts(struct yaml_reader *reader, yaml_node_t *node, const char *name, struct notify_list *list,
                       void (*check)(struct yaml_reader *reader, struct text_position place, const char *name, const char *text))
{
    bool one = node->type == YAML_SCALAR_NODE;
    int count = one ? 1 : yaml_list_count(reader, node, name);
    if (count > NOTIFY_LIST)
        yaml_error(reader, yaml_place(node), "%s: expected at most %d, found %d", name, NOTIFY_LIST, count);
    if (count == 0)
        yaml_error(reader, yaml_place(node), "%s: expected at least one item, found an empty list", name);
    for (int i = 0; i < count && i < NOTIFY_LIST; i++) {
        yaml_node_t *item = one ? node : yaml_list_item(reader, node, i);
        const char *text = yaml_text(item);
        if (!text || !*text)
            yaml_expected(reader, item, name, "text");
        else if (check)
            check(reader, yaml_place(item), name, text);
        if (text && *text)
            list->at[list->count++] = mem_strdup(text);
    }
}

static void read_email(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    read_texts(reader, node, "email", &((struct notify_recipient *)record)->addresses, check_mail_address);
}

static void read_areas(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    read_texts(reader, node, "areas", &((struct notify_rule *)record)->areas, NULL);
}

static void free_list(struct notify_list *list)
{
    for (size_t i = 0; i < list->count; i++)
        mem_free(list->at[i]);
}

/* --- mail server, recipients ------------------------------------------------------------------------------------------------ */

static void read_mail(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    static const struct yaml_key keys[] = {
        { "server", KEY_NAME, true, offsetof(struct notify_mail, server), 0, 0, NULL, NULL },
        { "from", KEY_NAME, true, offsetof(struct notify_mail, from), 0, 0, NULL, NULL },
        { "user", KEY_NAME, false, offsetof(struct notify_mail, user), 0, 0, NULL, NULL },
        { "password_file", KEY_NAME, false, offsetof(struct notify_mail, password_file), 0, 0, NULL, NULL },
        { "ca_file", KEY_NAME, false, offsetof(struct notify_mail, ca_file), 0, 0, NULL, NULL },
        { 0 }
    };
    struct plant *plant = record;
    struct notify_mail *mail = &plant->notify->mail;
    struct yaml_map map;
    if (!yaml_map_read(reader, node, "mail", keys, mail, &map))
        return;
    url_check(reader, &map, "server", mail->server, "smtp://", "smtps://");
    if (yaml_map_good(&map, "from"))
        check_mail_address(reader, yaml_map_place(&map, "from"), "from", mail->from);
    if (!mail->user != !mail->password_file)
        yaml_error(reader, map.place, "mail: expected both user and password_file, or neither");
    plant_resolve_path(plant, &mail->password_file);
    plant_resolve_path(plant, &mail->ca_file);
}

struct recipient_record {
    /* must be first: read_email() gets a pointer to the struct and converts it to a pointer to this member */
    struct notify_recipient recipient;
    char *webhook, *alertmanager;
};

static void check_token(struct yaml_reader *reader, const struct yaml_map *map, const struct notify_recipient *recipient)
{
    if (recipient->token_file && recipient->kind == NOTIFY_EMAIL)
        yaml_error(reader, yaml_map_place(map, "token_file"), "token_file: not allowed for a recipient of e-mail");
    else
        url_check_token(reader, map, recipient->url);
}

static void read_recipient(struct yaml_reader *reader, yaml_node_t *node, struct plant *plant, struct notify_recipient *recipient)
{
    static const struct yaml_key keys[] = {
        { "id", KEY_NAME, true, offsetof(struct recipient_record, recipient.id), 0, 0, NULL, NULL },
        { "email", KEY_CUSTOM, false, 0, 0, 0, NULL, read_email },
        { "webhook", KEY_NAME, false, offsetof(struct recipient_record, webhook), 0, 0, NULL, NULL },
        { "alertmanager", KEY_NAME, false, offsetof(struct recipient_record, alertmanager), 0, 0, NULL, NULL },
        { "token_file", KEY_NAME, false, offsetof(struct recipient_record, recipient.token_file), 0, 0, NULL, NULL },
        { "ca_file", KEY_NAME, false, offsetof(struct recipient_record, recipient.ca_file), 0, 0, NULL, NULL },
        { 0 }
    };
    struct recipient_record record = { .recipient = { .line = yaml_place(node).line } };
    struct yaml_map map;
    bool is_map = yaml_map_read(reader, node, "a recipient", keys, &record, &map);
    record.recipient.kind = record.alertmanager ? NOTIFY_ALERTMANAGER : record.webhook ? NOTIFY_WEBHOOK : NOTIFY_EMAIL;
    record.recipient.url = record.alertmanager ? record.alertmanager : record.webhook;
    if (record.alertmanager && record.webhook)
        mem_free(record.webhook);
    *recipient = record.recipient;
    plant_resolve_path(plant, &recipient->token_file);
    plant_resolve_path(plant, &recipient->ca_file);
    if (!is_map)
        return;
    if (yaml_map_has(&map, "email") + yaml_map_has(&map, "webhook") + yaml_map_has(&map, "alertmanager") != 1)
        yaml_error(reader, map.place, "a recipient: expected exactly one of email, webhook and alertmanager");
    else if (recipient->kind == NOTIFY_EMAIL && !plant->notify->mail.server)
        yaml_error(reader, yaml_map_place(&map, "email"), "email: requires a server in the key `mail`");
    else if (recipient->kind != NOTIFY_EMAIL)
        url_check(reader, &map, recipient->kind == NOTIFY_WEBHOOK ? "webhook" : "alertmanager", recipient->url, "http://", "https://");
    if (recipient->id && strcspn(recipient->id, "\"\\\n") != strlen(recipient->id))
        yaml_error(reader, yaml_map_place(&map, "id"), "id: must not contain quotes or backslashes");
    check_token(reader, &map, recipient);
    plant_list_check_id(reader, &map, "recipient", plant->notify->recipients, plant->notify->recipient_count, sizeof(*recipient),
                        offsetof(struct notify_recipient, line));
}

static void read_recipients(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    struct plant *plant = record;
    struct plant_notify *notify = plant->notify;
    int count;
    notify->recipients = plant_list_make(reader, node, "recipients", 1, NOTIFY_RECIPIENTS, sizeof(*notify->recipients), &count);
    for (int i = 0; i < count; i++)
        read_recipient(reader, yaml_list_item(reader, node, i), plant, &notify->recipients[notify->recipient_count++]);
}

/* --- rules ------------------------------------------------------------------------------------------------------------------ */

struct rule_record {
    struct notify_rule rule; /* must be first: read_areas() gets a pointer to the struct and converts it to a pointer to this member */
    const struct plant_notify *notify;
};

static uint32_t read_to(struct yaml_reader *reader, yaml_node_t *node, const struct plant_notify *notify)
{
    struct notify_list names = { 0 };
    uint32_t to = 0;
    read_texts(reader, node, "to", &names, NULL);
    for (size_t i = 0; i < names.count; i++) {
        size_t k = 0;
        while (k < notify->recipient_count && (!notify->recipients[k].id || strcmp(notify->recipients[k].id, names.at[i]) != 0))
            k++;
        if (k == notify->recipient_count)
            yaml_error(reader, yaml_place(node), "to: unknown recipient '%.60s'", names.at[i]);
        else
            to |= UINT32_C(1) << k;
    }
    free_list(&names);
    return to;
}

static void read_first(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    struct rule_record *rule = record;
    rule->rule.steps[0].to = read_to(reader, node, rule->notify);
}

struct step_record {
    struct notify_step step;
    const struct plant_notify *notify;
};

static void read_step_to(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    struct step_record *step = record;
    step->step.to = read_to(reader, node, step->notify);
}

static void read_escalation(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    static const struct yaml_key keys[] = { { "after_min", KEY_NUMBER, true, offsetof(struct step_record, step.after_min), 1. / 60,
                                              7 * 24 * 60, NULL, NULL },
                                            { "to", KEY_CUSTOM, true, 0, 0, 0, NULL, read_step_to },
                                            { 0 } };
    struct rule_record *rule = record;
    int count = yaml_list_count(reader, node, "escalate");
    if (count >= NOTIFY_STEPS)
        yaml_error(reader, yaml_place(node), "escalate: expected at most %d steps, found %d", NOTIFY_STEPS - 1, count);
    for (int i = 0; i < count && i < NOTIFY_STEPS - 1; i++) {
        struct step_record step = { .notify = rule->notify };
        struct yaml_map map;
        bool good = yaml_map_read(reader, yaml_list_item(reader, node, i), "a step", keys, &step, &map) && yaml_map_good(&map, "after_min");
        if (good && i > 0 && step.step.after_min <= rule->rule.steps[i].after_min)
            yaml_error(reader, yaml_map_place(&map, "after_min"),
                       "after_min: expected a number greater than the previous one (%.9g), found %.9g", rule->rule.steps[i].after_min,
                       step.step.after_min);
        rule->rule.steps[1 + i] = step.step;
        rule->rule.step_count = (size_t)i + 2;
    }
}

static int find_day(const char *text, size_t length)
{
    static const char *const names[DAYS] = { "mon", "tue", "wed", "thu", "fri", "sat", "sun" };
    for (int i = 0; i < DAYS; i++)
        if (length == 3 && !strncmp(text, names[i], 3))
            return i;
    return -1;
}

/* Parses `mon` or `fri-mon` to a bit mask. Returns 0 if the text is neither. */
static unsigned days_of(const char *text)
{
    size_t length = strcspn(text, "-");
    int from = find_day(text, length), to = text[length] ? find_day(text + length + 1, strlen(text + length + 1)) : from;
    if (from < 0 || to < 0)
        return 0;
    unsigned days = 1u << from;
    for (int day = from; day != to; days |= 1u << day)
        day = (day + 1) % DAYS;
    return days;
}

static void check_days(struct yaml_reader *reader, struct text_position place, const char *name, const char *text)
{
    if (!days_of(text))
        yaml_error(reader, place, "%s: expected mon, tue, wed, thu, fri, sat, sun or a span such as mon-fri, found '%.40s'", name, text);
}

static void read_days(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    struct notify_list spans = { 0 };
    struct notify_shift *shift = &((struct rule_record *)record)->rule.shift;
    read_texts(reader, node, "days", &spans, check_days);
    shift->days = 0;
    for (size_t i = 0; i < spans.count; i++)
        shift->days |= days_of(spans.at[i]);
    free_list(&spans);
}

static bool read_minute(const char *text, int *minute)
{
    int hours, minutes, end = 0;
    if (sscanf(text, "%2d:%2d%n", &hours, &minutes, &end) != 2 || end != 5 || hours < 0 || minutes < 0 || minutes > 59)
        return false;
    *minute = hours * 60 + minutes;
    return *minute <= MIN_PER_DAY;
}

bool plant_day_span_read(struct yaml_reader *reader, yaml_node_t *node, const char *name, int *from_min, int *to_min)
{
    const char *text = yaml_text(node);
    char from[6] = { 0 };
    if (text && strlen(text) == 11 && text[5] == '-') {
        memcpy(from, text, 5);
        if (read_minute(from, from_min) && read_minute(text + 6, to_min)) {
            *from_min %= MIN_PER_DAY;
            *to_min %= MIN_PER_DAY;
            return true;
        }
    }
    yaml_expected(reader, node, name, "a span such as 06:00-14:00 or 22:00-06:00");
    return false;
}

static void read_hours(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    struct notify_shift *shift = &((struct rule_record *)record)->rule.shift;
    plant_day_span_read(reader, node, "hours", &shift->from_min, &shift->to_min);
}

static void read_rule(struct yaml_reader *reader, yaml_node_t *node, struct plant_notify *notify, struct notify_rule *rule)
{
    static const struct yaml_key keys[] = {
        { "id", KEY_NAME, true, offsetof(struct rule_record, rule.id), 0, 0, NULL, NULL },
        { "priority", KEY_INT, false, offsetof(struct rule_record, rule.priority), 1, ALARM_PRIORITIES, NULL, NULL },
        { "areas", KEY_CUSTOM, false, 0, 0, 0, NULL, read_areas },
        { "days", KEY_CUSTOM, false, 0, 0, 0, NULL, read_days },
        { "hours", KEY_CUSTOM, false, 0, 0, 0, NULL, read_hours },
        { "to", KEY_CUSTOM, true, 0, 0, 0, NULL, read_first },
        { "escalate", KEY_CUSTOM, false, 0, 0, 0, NULL, read_escalation },
        { 0 }
    };
    struct rule_record record = { .rule = { .priority = ALARM_PRIORITIES,
                                            .shift = { .days = ALL_DAYS },
                                            .step_count = 1,
                                            .line = yaml_place(node).line },
                                  .notify = notify };
    struct yaml_map map;
    bool is_map = yaml_map_read(reader, node, "a rule", keys, &record, &map);
    *rule = record.rule;
    if (is_map)
        plant_list_check_id(reader, &map, "rule", notify->rules, notify->rule_count, sizeof(*rule), offsetof(struct notify_rule, line));
}

static void read_rules(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    struct plant_notify *notify = ((struct plant *)record)->notify;
    int count;
    notify->rules = plant_list_make(reader, node, "rules", 1, NOTIFY_RULES, sizeof(*notify->rules), &count);
    for (int i = 0; i < count; i++)
        read_rule(reader, yaml_list_item(reader, node, i), notify, &notify->rules[notify->rule_count++]);
}

/* --- the key `notify` ------------------------------------------------------------------------------------------------------- */

static yaml_node_t *value_of(struct yaml_reader *reader, const yaml_node_t *map, const char *key)
{
    if (map->type != YAML_MAPPING_NODE)
        return NULL;
    for (const yaml_node_pair_t *pair = map->data.mapping.pairs.start; pair < map->data.mapping.pairs.top; pair++) {
        const char *name = yaml_text(yaml_document_get_node(&reader->doc, pair->key));
        if (name && !strcmp(name, key))
            return yaml_document_get_node(&reader->doc, pair->value);
    }
    return NULL;
}

/* Skips a key: plant_notify_read() reads these keys later in a fixed order, because rules refer to recipients and recipients to
   the mail server. */
static void read_later(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    (void)reader;
    (void)node;
    (void)record;
}

static void read_scalars(struct yaml_reader *reader, yaml_node_t *node, struct plant *plant)
{
    static const struct yaml_key keys[] = {
        { "link", KEY_NAME, false, offsetof(struct plant_notify, link), 0, 0, NULL, NULL },
        { "gather_s", KEY_NUMBER, false, offsetof(struct plant_notify, gather_s), 0, 600, NULL, NULL },
        { "pause_s", KEY_NUMBER, false, offsetof(struct plant_notify, pause_s), 0, 86400, NULL, NULL },
        { "timeout_s", KEY_NUMBER, false, offsetof(struct plant_notify, timeout_s), 1, 120, NULL, NULL },
        { "mail", KEY_CUSTOM, false, 0, 0, 0, NULL, read_later },
        { "recipients", KEY_CUSTOM, true, 0, 0, 0, NULL, read_later },
        { "rules", KEY_CUSTOM, true, 0, 0, 0, NULL, read_later },
        { 0 }
    };
    struct yaml_map map;
    if (yaml_map_read(reader, node, "notify", keys, plant->notify, &map))
        url_check(reader, &map, "link", plant->notify->link, "http://", "https://");
}

void plant_notify_read(struct yaml_reader *reader, yaml_node_t *node, void *record)
{
    struct plant *plant = record;
    static const struct {
        const char *name;
        void (*read)(struct yaml_reader *reader, yaml_node_t *node, void *plant);
    } parts[] = { { "mail", read_mail }, { "recipients", read_recipients }, { "rules", read_rules } };
    plant->notify = mem_new(sizeof(*plant->notify));
    plant->notify->gather_s = 3;
    plant->notify->pause_s = 60;
    plant->notify->timeout_s = 30;
    read_scalars(reader, node, plant);
    for (size_t i = 0; i < sizeof(parts) / sizeof(*parts); i++) {
        yaml_node_t *part = value_of(reader, node, parts[i].name);
        if (part)
            parts[i].read(reader, part, plant);
    }
}

void plant_notify_free(struct plant_notify **pointer)
{
    struct plant_notify *notify = *pointer;
    if (!notify)
        return;
    for (size_t i = 0; i < notify->recipient_count; i++) {
        struct notify_recipient *recipient = &notify->recipients[i];
        free_list(&recipient->addresses);
        mem_free(recipient->id);
        mem_free(recipient->url);
        mem_free(recipient->token_file);
        mem_free(recipient->ca_file);
    }
    for (size_t i = 0; i < notify->rule_count; i++) {
        free_list(&notify->rules[i].areas);
        mem_free(notify->rules[i].id);
    }
    mem_free(notify->mail.server);
    mem_free(notify->mail.from);
    mem_free(notify->mail.user);
    mem_free(notify->mail.password_file);
    mem_free(notify->mail.ca_file);
    mem_free(notify->recipients);
    mem_free(notify->rules);
    mem_free(notify->link);
    mem_free(notify);
    *pointer = NULL;
}
