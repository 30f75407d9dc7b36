/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Declares the tests of a program. Each test registers itself, so that none can be forgotten; they run in the order of the file. */
#ifndef TESTS_SUPPORT_TEST_H
#define TESTS_SUPPORT_TEST_H
#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h> /* cmocka.h needs setjmp.h, stdarg.h, stddef.h and stdint.h included before it */

#include "base/mem.h"
#include "tests/support/owned.h"
#include "tests/support/sweep.h"
#include "tests/support/temp.h"

/* Defines a test: TEST(readings_age) { ... }. `state` is what its fixture created. */
#define TEST(name) TEST_WITH(name, NULL, NULL)

/* Defines a test with its own fixtures: functions that run before and after it, or NULL. */
#define TEST_WITH(name, set_up, tear_down)                                                                                                 \
    static void name(void **state);                                                                                                        \
    static int name##_ends(void **state)                                                                                                   \
    {                                                                                                                                      \
        return test_end(tear_down, state);                                                                                                 \
    }                                                                                                                                      \
    __attribute__((constructor)) static void name##_is_registered(void)                                                                    \
    {                                                                                                                                      \
        test_add(&(struct CMUnitTest){ #name, name, set_up, name##_ends, NULL }, __LINE__);                                                \
    }                                                                                                                                      \
    static void name(__attribute__((unused)) void **state)

/* Defines a test that gets its fixture as a typed argument. A file with many such tests shortens it:
 * #define CASE(name) TEST_ON(struct fixture *f, name, set_up, tear_down) */
#define TEST_ON(argument, name, set_up, tear_down)                                                                                         \
    static void name##_on(__attribute__((unused)) argument);                                                                               \
    TEST_WITH(name, set_up, tear_down)                                                                                                     \
    {                                                                                                                                      \
        name##_on(*state);                                                                                                                 \
    }                                                                                                                                      \
    static void name##_on(__attribute__((unused)) argument)

/* Defines set_up() and tear_down() of a fixture: a `type` that is zeroed before each test, then passed to begin(), to the test
   and to end(). end: NULL if the test owns everything in the fixture (tests/support/owned.h). */
#define TEST_FIXTURE(type, begin, end)                                                                                                     \
    static int set_up(void **state)                                                                                                        \
    {                                                                                                                                      \
        static type fixture;                                                                                                               \
        memset(&fixture, 0, sizeof(fixture));                                                                                              \
        begin(&fixture);                                                                                                                   \
        *state = &fixture;                                                                                                                 \
        return 0;                                                                                                                          \
    }                                                                                                                                      \
    static int tear_down(void **state)                                                                                                     \
    {                                                                                                                                      \
        void (*finish)(type *) = end;                                                                                                      \
        if (finish)                                                                                                                        \
            finish(*state);                                                                                                                \
        return 0;                                                                                                                          \
    }

/* Sets the fixtures of the whole program: functions that run before its first and after its last test, or NULL. */
#define TEST_GROUP(set_up, tear_down)                                                                                                      \
    __attribute__((constructor)) static void group_is_registered(void)                                                                     \
    {                                                                                                                                      \
        test_group(set_up, tear_down);                                                                                                     \
    }

/* Called by the macros above, before main. */
void test_add(const struct CMUnitTest *test, int line);
void test_group(CMFixtureFunction set_up, CMFixtureFunction tear_down);
/* Calls the tear-down (NULL: none) at the end of a test and releases what the test owns. Returns the tear-down's result, or 0.
   */
int test_end(CMFixtureFunction tear_down, void **state);

/* Runs the tests of this program and prints TAP. Returns the number of failures. name: of the group, or NULL for the program's
   name. A program without main() gets one that calls this with NULL. */
int tests_run(const char *name);
/* A test program may define this function instead of main(). The main() of test_main.c then calls it in place of
   tests_run(NULL), and its result is the program's exit status. */
int tests_main(void);

#endif
