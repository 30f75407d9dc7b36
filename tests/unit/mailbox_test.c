/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The mailbox: newest wins, told once when it was empty, nothing torn between threads. */
#include "base/mailbox.h"

#include <pthread.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <cmocka.h>

struct letter {
    int numbers[64]; /* all alike: a torn copy shows */
};

static struct letter letter_of(int number)
{
    struct letter letter;
    for (int i = 0; i < 64; i++)
        letter.numbers[i] = number;
    return letter;
}

static void the_newest_wins(void **state)
{
    (void)state;
    struct mailbox box;
    struct letter one = letter_of(1), two = letter_of(2), got = letter_of(0);
    mailbox_init(&box, sizeof(one));
    assert_false(mailbox_take(&box, &got));
    assert_int_equal(got.numbers[0], 0);
    assert_true(mailbox_put(&box, &one));
    assert_false(mailbox_put(&box, &two)); /* the reader was woken already */
    assert_true(mailbox_take(&box, &got));
    assert_int_equal(got.numbers[63], 2);
    assert_false(mailbox_take(&box, &got));
    assert_true(mailbox_put(&box, &one));
    mailbox_finish(&box);
    mailbox_finish(&box);
}

enum { LETTERS = 20000 };

static void *write_letters(void *arg)
{
    for (int i = 1; i <= LETTERS; i++) {
        struct letter letter = letter_of(i);
        mailbox_put(arg, &letter);
    }
    return NULL;
}

static void threads_see_whole_letters_in_order(void **state)
{
    (void)state;
    struct mailbox box;
    struct letter got;
    pthread_t writer;
    int last = 0, torn = 0, backwards = 0;
    mailbox_init(&box, sizeof(got));
    assert_int_equal(pthread_create(&writer, NULL, write_letters, &box), 0);
    while (last < LETTERS) {
        if (!mailbox_take(&box, &got))
            continue;
        for (int i = 1; i < 64; i++)
            torn += got.numbers[i] != got.numbers[0];
        backwards += got.numbers[0] <= last;
        last = got.numbers[0];
    }
    pthread_join(writer, NULL);
    mailbox_finish(&box);
    assert_int_equal(torn, 0);
    assert_int_equal(backwards, 0);
}

int main(void)
{
    cmocka_set_message_output(CM_OUTPUT_TAP);
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(the_newest_wins),
        cmocka_unit_test(threads_see_whole_letters_in_order),
    };
    return cmocka_run_group_tests(tests, NULL, NULL);
}
