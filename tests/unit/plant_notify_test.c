/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The plant file's `notify` section: parsing, and errors reported with their position. */
#include "tests/support/test.h"

#include "plant/sections/notification.h"
#include "tests/support/plant_case.h"

#define CASE(name) TEST_ON(struct plant_case *c, name, plant_case_set_up, plant_case_tear_down)

static void load(struct plant_case *c, const char *notify)
{
    char *yaml = test_printf("plant: { name: P }\nassets: [{ id: E-1, model: m.glb }]\n"
                             "groups: [{ id: t, unit: degC, min: 0, max: 1 }]\ntags: tags.csv\n%s\n",
                             notify);
    plant_case_load(c, yaml, "Tag Name,Address\nT1,40001\n");
}

CASE(all_keys_are_read)
{
    load(c, "sources: [{ id: a, type: modbus, host: h }]\n"
            "notify:\n"
            "  link: https://p.example/\n  gather_s: 2\n  pause_s: 30\n  timeout_s: 5\n"
            "  rules:\n" /* a rule may come before the recipient that it names */
            "  - { id: all, to: [ops, hook] }\n"
            "  - { id: nights, priority: 2, areas: [\"Tank*\", E-1], days: [fri-mon], hours: \"22:00-06:00\", to: ops,"
            " escalate: [{ after_min: 10, to: boss }, { after_min: 30, to: [boss, hook] }] }\n"
            "  recipients:\n"
            "  - { id: ops, email: ops@p.example }\n  - { id: boss, email: [a@p.example, b@p.example] }\n"
            "  - { id: hook, webhook: \"https://h.example/x\", token_file: hook.token }\n"
            "  - { id: am, alertmanager: \"http://127.0.0.1:9093\", token_file: /t }\n"
            "  mail: { server: \"smtps://m.example\", from: p@p.example, user: p, password_file: pw, ca_file: ca.pem }");
    plant_case_assert_loaded(c, 0);
    const struct plant_notify *notify = c->plant->notify;
    char *password = test_printf("%s/pw", c->plant->files.folder);
    assert_string_equal(notify->mail.password_file, password);
    assert_int_equal(notify->recipient_count, 4);
    assert_int_equal(notify->recipients[1].addresses.count, 2);
    assert_int_equal(notify->recipients[2].kind, NOTIFY_WEBHOOK);
    assert_string_equal(notify->recipients[3].url, "http://127.0.0.1:9093");
    assert_int_equal(notify->rules[0].priority, 4);
    assert_int_equal(notify->rules[0].steps[0].to, 5);
    assert_int_equal(notify->rules[0].shift.days, 127);
    const struct notify_rule *nights = &notify->rules[1];
    assert_int_equal(nights->areas.count, 2);
    assert_int_equal(nights->shift.days, 1 << 4 | 1 << 5 | 1 << 6 | 1);
    assert_int_equal(nights->shift.from_min, 22 * 60);
    assert_int_equal(nights->shift.to_min, 6 * 60);
    assert_int_equal(nights->step_count, 3);
    assert_float_equal(nights->steps[2].after_min, 30, 0);
    assert_int_equal(nights->steps[2].to, 6);
}

CASE(secrets_do_not_stand_in_the_file)
{
    load(c, "notify:\n  mail: { server: \"smtps://me:secret@m.example\", from: p@p.example, password: secret }\n"
            "  recipients:\n  - { id: a, webhook: \"https://u:p@h.example/\" }\n"
            "  - { id: b, webhook: \"http://h.example/\", token_file: t }\n  rules: [{ id: r, to: a }]");
    FOUND(c, { "plant.yaml", 6, 69, "unknown key 'password'" }, { "plant.yaml", 6, 19, "do not write a password in the plant file" },
          { "plant.yaml", 8, 23, "do not write a password in the plant file" },
          { "plant.yaml", 9, 56, "token_file: needs an address that begins with https://" });
}

CASE(what_is_wrong_is_said_at_its_place)
{
    load(c, "notify:\n  gather_s: -1\n  recipients:\n  - { id: a, email: nobody }\n  - { id: a, webhook: \"ftp://h/\" }\n  - { id: c }\n"
            "  rules:\n  - { id: r, to: [b], days: [mon-foo], hours: 6-14 }\n"
            "  - { id: r, to: a, priority: 5, escalate: [{ after_min: 9, to: c }, { after_min: 9, to: c }] }\n  - { id: s }");
    FOUND(c, { "plant.yaml", 6, 13, "gather_s: expected" }, { "plant.yaml", 8, 21, "email: expected an address" },
          { "plant.yaml", 8, 21, "requires a server in the key `mail`" },
          { "plant.yaml", 9, 23, "begins with a scheme (such as https://) that is not supported here" },
          { "plant.yaml", 9, 11, "'a' is listed twice (first at line 8)" },
          { "plant.yaml", 10, 5, "expected exactly one of email, webhook" }, { "plant.yaml", 12, 18, "unknown recipient 'b'" },
          { "plant.yaml", 12, 30, "or a span such as mon-fri" }, { "plant.yaml", 12, 47, "a span such as 06:00-14:00" },
          { "plant.yaml", 13, 31, "priority: expected" }, { "plant.yaml", 13, 83, "expected a number greater than the previous one (9)" },
          { "plant.yaml", 13, 11, "rule 'r' is listed twice" }, { "plant.yaml", 14, 5, "a rule needs the key 'to'" });
}

CASE(it_needs_the_history)
{
    load(c, "history: { record: no }\nnotify: { recipients: [{ id: a, webhook: \"https://h/\" }], rules: [{ id: r, to: a }] }");
    FOUND(c, { "plant.yaml", 6, 9, "`notify` requires `record: yes`" });
    load(c, "notify: []");
    FOUND(c, { "plant.yaml", 5, 9, "notify: expected a mapping" });
}
