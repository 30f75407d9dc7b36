/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Parses and carries out messages about notes. A note is attached to a tag, an asset, a position or the whole plant. */
#include "message/note_message.h"

#include "base/mem.h"
#include "base/text/json_text.h"
#include "message/json_fields.h"

/* Looks up the index of the tag or asset named by a member of the message; *out is -1 if the member is absent. Returns false
 * with error if the name is unknown. */
static bool find_named(const json_t *o, const struct plant *plant, const char *member,
                       int (*find)(const struct plant *plant, const char *name), enum refusal_code missing, int *out,
                       struct message_error *error)
{
    const json_t *name = json_object_get(o, member);
    const char *text = json_is_string(name) ? json_string_value(name) : "";
    char cut[48];
    *out = *text ? find(plant, text) : -1;
    if (*out >= 0 || !name)
        return true;
    message_refuse_with(error, "bad_field", member, missing, "name=%s", quoted(text, cut));
    return false;
}

bool note_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    struct note_request *note = &out->note;
    double until_us = 0;
    bool replaces;
    if (!need_seq(o, &out->seq, error) || !need_words(o, "text", true, note->text, sizeof(note->text), error) ||
        !need_words(o, "name", false, note->name, sizeof(note->name), error) ||
        !may_text(o, "replaces", note->id, sizeof(note->id), &replaces, error) ||
        !find_named(o, plant, "tag", plant_find_tag, REFUSAL_NO_TAG, &note->tag, error) ||
        !find_named(o, plant, "asset", plant_find_asset, REFUSAL_NO_ASSET, &note->asset, error) ||
        !may_vector(o, "position", note->position_m, &note->has_position, error) ||
        !may_number(o, "until_us", 1, 9e15, &until_us, NULL, error))
        return false;
    note->until_us = (int64_t)until_us;
    if ((note->tag >= 0) + (note->asset >= 0) + note->has_position + replaces <= 1)
        return true;
    message_fail(error, "bad_field", "tag, asset, position, replaces: expected at most one of these four fields");
    return false;
}

bool remove_note_parse(const struct plant *plant, const json_t *o, struct message *out, struct message_error *error)
{
    bool given;
    (void)plant;
    if (!need_seq(o, &out->seq, error) || !may_text(o, "id", out->note.id, sizeof(out->note.id), &given, error) ||
        !need_words(o, "name", false, out->note.name, sizeof(out->note.name), error))
        return false;
    if (!given)
        message_fail(error, "bad_field", "id: expected the id of a note");
    return given;
}

/* Adds the result of adding or ending a note to a JSON answer. If the refusal concerns another user's note, also names its author. */
static void add_result(json_t *answer, enum refusal_code code, const char *author)
{
    struct refusal why = { .code = code };
    if (code == REFUSAL_NOTE_OTHERS)
        refusal_set(&why, REFUSAL_NOTE_OTHERS, "author=%s", author);
    else if (code == REFUSAL_NOTE_NOT_OWN)
        refusal_set(&why, REFUSAL_NOTE_NOT_OWN, "author=%s", author);
    refusal_add_with(answer, &why);
}

char *note_do(struct notes *notes, const struct plant *plant, const struct message *message, const char *who, bool may_end_others,
              int64_t now_us)
{
    const struct note_request *request = &message->note;
    char *person = request->name[0] ? mem_printf("%.40s (%s)", request->name, who) : mem_strdup(who), id[NOTE_ID_BYTES] = "";
    const struct note note = { .text = request->text,
                               .tag = request->tag >= 0 ? plant->tags[request->tag].name : NULL,
                               .asset = request->asset >= 0 ? plant->assets[request->asset].id : NULL,
                               .position_m = request->has_position ? request->position_m : NULL,
                               .replaces = request->id[0] ? request->id : NULL,
                               .until_us = request->until_us };
    bool adds = message->type == MESSAGE_NOTE;
    enum refusal_code why =
        adds ? notes_add(notes, &note, person, now_us, id) : notes_end(notes, request->id, person, may_end_others, now_us);
    mem_free(person);
    json_t *answer =
        json_pack("{s:s,s:I,s:s,s:b}", "type", "noted", "seq", (json_int_t)message->seq, "id", adds ? id : request->id, "kept", !why);
    add_result(answer, why, notes_author(notes, request->id));
    return json_text(answer, 0);
}
