/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The CSV parser: the cells of each row, and the line and column that it reports for every cell. */
#include "plant/parse/csv.h"

#include "tests/support/test.h"

#include "base/text/text.h"

struct csv_fixture {
    char *folder, *path;
    struct diag diag;
    struct csv csv;
};

static void begin(struct csv_fixture *f)
{
    f->folder = temp_folder();
    f->path = temp_path(f->folder, "t.csv");
}

static void forget(struct csv_fixture *f)
{
    csv_close(&f->csv);
    diag_finish(&f->diag);
}

static void end(struct csv_fixture *f)
{
    forget(f);
}

TEST_FIXTURE(struct csv_fixture, begin, end)

#define CASE(name) TEST_ON(struct csv_fixture *f, name, set_up, tear_down)

static void open_bytes(struct csv_fixture *f, const char *text, size_t bytes)
{
    forget(f);
    temp_write(f->folder, "t.csv", text, bytes);
    assert_true(csv_open(&f->csv, f->path, &f->diag));
}

static void open_text(struct csv_fixture *f, const char *text)
{
    open_bytes(f, text, strlen(text));
}

/* Asserts the cells of the next row. joined: the expected cells, separated by "|". */
static void assert_row(struct csv_fixture *f, const char *joined)
{
    char got[1000] = "";
    assert_true(csv_next(&f->csv));
    for (size_t i = 0; i < f->csv.row.count; i++)
        snprintf(got + strlen(got), sizeof(got) - strlen(got), "%s%s", i ? "|" : "", f->csv.row.cells[i].text);
    assert_string_equal(got, joined);
}

static void assert_one_error(struct csv_fixture *f, int line, int column, const char *words)
{
    while (csv_next(&f->csv))
        ;
    if (f->diag.count != 1)
        diag_print(&f->diag, stderr);
    assert_int_equal(f->diag.count, 1);
    const struct diag_item *item = &f->diag.items[0];
    if (item->line != line || item->column != column || !strstr(item->text, words))
        fail_msg("%d:%d: %s is not %d:%d: %s", item->line, item->column, item->text, line, column, words);
}

CASE(separators_are_detected)
{
    static const char *const texts[] = { "A,B,C\n1,2;x,3\n", "A;B;C\r\n1;2,x;3\r\n", "A\tB\tC\r1\t 2 \t3", "\"A,,,,\";B;C\n1;2;3" };
    static const char *const rows[] = { "1|2;x|3", "1|2,x|3", "1|2|3", "1|2|3" };
    for (size_t i = 0; i < 4; i++) {
        open_text(f, texts[i]);
        assert_int_equal(f->csv.header.count, 3);
        assert_row(f, rows[i]);
        assert_false(csv_next(&f->csv));
        assert_int_equal(f->diag.count, 0);
    }
}

CASE(quotes_hold_separators_quotes_and_line_breaks)
{
    open_text(f, "A,B,C\n\"x,y\",\"say \"\"hi\"\"\", \"two\nlines\" \n  3\" pipe ,\"\",\"  kept  \"\nlast,,end");
    assert_row(f, "x,y|say \"hi\"|two\nlines");
    assert_int_equal(csv_cell_line(&f->csv, 2), 2);
    assert_int_equal(csv_cell_column(&f->csv, 2), 21);
    assert_row(f, "3\" pipe||  kept  "); /* a quote inside a cell that does not begin with a quote is literal */
    assert_int_equal(csv_cell_line(&f->csv, 0), 4);
    assert_int_equal(csv_cell_column(&f->csv, 0), 3);
    assert_row(f, "last||end");
    assert_int_equal(csv_cell_line(&f->csv, 0), 5);
    assert_false(csv_next(&f->csv));
    assert_int_equal(f->diag.count, 0);
}

CASE(columns_count_characters)
{
    open_text(f, "\xEF\xBB\xBFName,Größe °C,C\r\n\"äöü\",€,x\r\n");
    assert_int_equal(f->csv.header.cells[0].column, 1);
    assert_int_equal(f->csv.header.cells[2].column, 15);
    assert_int_equal(csv_find(&f->csv, "NAME"), 0);
    assert_int_equal(csv_find(&f->csv, "größe °C"), 1);
    assert_int_equal(csv_find(&f->csv, "D"), -1);
    assert_row(f, "äöü|€|x");
    assert_int_equal(csv_cell_column(&f->csv, 1), 7);
    assert_int_equal(csv_cell_column(&f->csv, 2), 9);
    assert_int_equal(csv_cell_line(&f->csv, 2), 2);
}

CASE(blank_rows_are_passed_over)
{
    open_text(f, "\n  \nA,B,,\n\n,,,\n1,2,,,,\n \r\n3\n\n");
    assert_int_equal(f->csv.header.count, 2);
    assert_int_equal(f->csv.header.cells[0].line, 3);
    assert_row(f, "1|2||||"); /* blank cells beyond the last column, as spreadsheets write them, are no error */
    assert_int_equal(csv_cell_line(&f->csv, 0), 6);
    assert_row(f, "3");
    assert_string_equal(csv_text(&f->csv, 1), "");
    assert_string_equal(csv_text(&f->csv, -1), "");
    assert_int_equal(csv_cell_line(&f->csv, 1), 8);
    assert_int_equal(csv_cell_column(&f->csv, 1), 1);
    assert_false(csv_next(&f->csv));
    assert_false(csv_next(&f->csv));
    assert_int_equal(f->diag.count, 0);
}

CASE(mistakes_have_a_place)
{
    open_text(f, "A,B\n1,\"open\n2,3\n");
    assert_one_error(f, 2, 3, "a quote that begins here is never closed");
    open_text(f, "A,B\n1,\"x\" y\n2,3\n");
    assert_one_error(f, 2, 7, "text after the closing quote");
    open_text(f, "A,B\n1,2\n1,2,,4,5\n");
    assert_one_error(f, 3, 6, "cell 4, but the header has only 2 columns");
    open_text(f, "A,B, a\n");
    assert_one_error(f, 1, 6, "column 'a' is listed twice (first at column 1)");
    open_text(f, "A,B\n1,x\xB0\xB0y\n");
    assert_one_error(f, 2, 4, "byte 0xB0 is not UTF-8 text");
    open_bytes(f, "A,B\n1,\0\n", 8);
    assert_one_error(f, 2, 3, "byte 0x00 is not UTF-8 text");
    open_text(f, "A,B\n1,\xED\xA0\x80\n"); /* a surrogate, which UTF-8 forbids */
    assert_one_error(f, 2, 3, "byte 0xED is not UTF-8 text");
    open_text(f, "A,B\n1,\xC0\xAF\n"); /* "/" in an overlong encoding, which UTF-8 forbids */
    assert_one_error(f, 2, 3, "byte 0xC0 is not UTF-8 text");
}

/* A file that is no table must give a single error, and a text in a wrong encoding at most ten, not one per line. */
CASE(what_is_no_table_is_said_once)
{
    static const struct {
        const char *begins, *says;
    } others[] = {
        { "glTF\2\xFF\xFE\xFD\xFC\n\xFF\n\xFF\n\xFF\n", "is a model (GLB); expected a table (CSV)" },
        { "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('AUTOMOTIVE_DESIGN'));\n", "is a STEP file; expected a table (CSV)" },
        { "ISO-10303-21;\nHEADER;\nFILE_SCHEMA(('IFC4'));\n", "is an IFC model" },
        { "PK\x03\x04\x14", "is a ZIP archive, or a document in ZIP format (XLSX, DOCX, 3MF); expected a table (CSV)" },
        { "\xFE\xAA\n\xFE\xAA\n\xFE\xAA\n\xFE\xAA\n\xFE\xAA\n\xFE\xAA\n", "is not a text file; expected a table (CSV)" },
    };
    for (size_t i = 0; i < sizeof(others) / sizeof(*others); i++) {
        char *path = temp_write_text(f->folder, "t.csv", others[i].begins);
        struct diag diag = { 0 };
        struct csv csv;
        assert_false(csv_open(&csv, path, &diag));
        assert_int_equal(diag.errors, 1);
        assert_non_null(strstr(diag.items[0].text, others[i].says));
        diag_finish(&diag);
    }
    struct text *latin = test_text();
    struct csv csv;
    struct diag diag = { 0 };
    text_add(latin, "Tag Name,Eng Units\n");
    for (int i = 0; i < 300; i++)
        text_add(latin, "TT-%d some words of description,\xB0" "C\n", i);
    char *path = temp_write_text(f->folder, "t.csv", latin->at);
    assert_true(csv_open(&csv, path, &diag));
    assert_int_equal(diag.errors, 11);
    assert_non_null(strstr(diag.items[10].text, "300 lines contain bytes that are not UTF-8 text"));
    csv_close(&csv);
    diag_finish(&diag);
}

CASE(reading_goes_on_after_a_mistake)
{
    open_text(f, "A,B\n\"1\" x,2\n3,\xFF\n4,5\n");
    assert_row(f, "1|2");
    assert_row(f, "3|_");
    assert_row(f, "4|5");
    assert_int_equal(f->diag.errors, 2);
}

CASE(files_without_a_header_are_refused)
{
    static const char *const texts[] = { "", "\n \r\n", ",,,\n", "\xEF\xBB\xBF" };
    for (size_t i = 0; i < 4; i++) {
        temp_write_text(f->folder, "t.csv", texts[i]);
        assert_false(csv_open(&f->csv, f->path, &f->diag));
        assert_int_equal(f->diag.errors, i + 1);
    }
}
