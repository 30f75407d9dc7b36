/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast backup` and `plantcast restore`: copy a plant's history, alarm journal and configuration into one folder, and
   back. If the argument is an instance of the system service, the command executes the script deploy/backup or deploy/restore
   instead. The script then calls this command again with paths. */
#include <dirent.h>
#include <errno.h>
#include <getopt.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "alarm/journal.h"
#include "base/files/atomic_file.h"
#include "base/clock.h"
#include "base/mem.h"
#include "base/text/text.h"
#include "clients/cli/commands.h"
#include "history/copy.h"
#include "history/history.h"
#include "history/month.h"
#include "base/text/timestamp.h"
#include "plant/plant.h"
#include "version.h"
#include "loopcheck/loop_checks.h"
#include "access/pairings.h"
#include "views/named_views.h"
#include "views/notes.h"
#include "views/short_links.h"
#include "views/wall_remote.h"

#define MANIFEST "backup.json"
#define PLANT_FILE "plant.yaml"
enum { MANIFEST_VERSION = 1, MANIFEST_MAX = 1 << 20 };

struct backup_job {
    struct log *log;
    const char *folder;  /* backup folder */
    const char *history; /* value of --history */
    /* array of the manifest's entries: {"name":...,"bytes":...,"xxh128":...}; "service":true marks a file that option --add put
       into the backup */
    json_t *files;
    json_t *added;       /* paths of --add */
};

static void print_usage(FILE *out)
{
    fputs("usage: plantcast backup NAME --recipient KEY|--passphrase|--without-secrets [-o FOLDER] [--to URL]\n"
          "       plantcast restore FOLDER|URL [--identity FILE] [--without-secrets]\n"
          "       plantcast backup PLANT.yaml -o FOLDER [--history DIR]\n"
          "       plantcast backup --verify FOLDER\n"
          "       plantcast restore FOLDER PLANT.yaml [--history DIR]\n"
          "\n"
          "backup NAME backs up all files of the service plantcastd@NAME and verifies the backup. The service can keep running.\n"
          "Included: plant file, models, options, keys, tokens, sign-in settings, tag list, history, alarm journal, audit\n"
          "trail, views, notes, and all other files named in the options or the plant file. Not included: prepared files.\n"
          "restore FOLDER sets up the service from the backup, on a machine that has only the packages installed.\n"
          "\n"
          "  -o, --out FOLDER        folder to create for the backup (default: /var/backups/plantcast/NAME/TIME)\n"
          "  --recipient KEY         public key (age1..., ssh-ed25519 ...) with which age encrypts keys and tokens;\n"
          "                          may be repeated to encrypt for several recipients\n"
          "  --recipients-file FILE  file of public keys, one per line, with which age encrypts keys and tokens\n"
          "  --passphrase            encrypt keys and tokens with a passphrase; age prompts for it\n"
          "  --without-secrets       leave keys, tokens and sign-in settings out of the backup; with restore: do not\n"
          "                          restore the encrypted keys, tokens and sign-in settings\n"
          "  --to sftp://[USER@]HOST[:PORT]/FOLDER    also copy the backup to HOST by SFTP, with an SSH key\n"
          "  --hook PROGRAM          run PROGRAM after the backup, with the backup's folder as its argument\n"
          "  --keep N                after the backup, delete all but the newest N backups of this plant in\n"
          "                          /var/backups/plantcast/NAME, and all but the newest N copies at --to\n"
          "  --identity FILE         private key with which age decrypts keys and tokens (default: age prompts for\n"
          "                          the passphrase)\n"
          "  --root DIR              use the files below DIR instead of /, for tests and system images\n"
          "\n"
          "backup PLANT.yaml copies history, alarm journal, loop checks, plant file and tag list to FOLDER.\n"
          "Only the owner can read FOLDER. The daemon can keep running: the copy of each database is consistent.\n"
          "backup PLANT.yaml copies no models and follows no symbolic links.\n"
          "A file whose owner differs from the owner of its folder is skipped, even if root runs the command.\n"
          "\n"
          "--verify restores a backup into a temporary folder, compares all files and checks each database.\n"
          "\n"
          "restore FOLDER PLANT.yaml checks the backup in FOLDER and writes the plant file to PLANT.yaml.\n"
          "The tag list and the history are written to the paths that the plant file names.\n"
          "If root runs restore, each restored file gets the owner of its folder.\n"
          "If one of the files to restore exists already, restore writes nothing and fails.\n"
          "\n"
          "  --history DIR           folder of recorded readings (default: the folder given in the plant file, else\n"
          "                          /var/lib/plantcast/NAME/history for the service plantcastd@NAME, else PLANT.history)\n",
          out);
}

static bool say(const char *what, const char *why)
{
    fprintf(stderr, "plantcast: %s: %s\n", what, why);
    return false;
}

static char *history_folder(const struct backup_job *job, const struct plant *plant)
{
    return job->history ? mem_strdup(job->history) : plant_recorded_folder(plant);
}

/* Returns a path as the plant file would write it: relative if it is below the plant file's folder, else absolute. */
static const char *as_written(const struct plant *plant, const char *path)
{
    size_t n = strlen(plant->files.folder);
    return !strncmp(path, plant->files.folder, n) && path[n] == '/' ? path + n + 1 : path;
}

/* Files in the history folder with what users enter on the page, such as saved views and notes. */
static const char *const lists[] = { NAMED_VIEWS_FILE, SHORT_LINKS_FILE, NOTES_FILE, WALL_REMOTE_FILE, PAIRINGS_FILE };
enum { LISTS = sizeof(lists) / sizeof(lists[0]) };

static bool is_list(const char *name)
{
    for (int i = 0; i < LISTS; i++)
        if (!strcmp(name, lists[i]))
            return true;
    return false;
}

static bool is_ours(const char *name)
{
    int month;
    return month_parse(name, &month) || !strcmp(name, JOURNAL_FILE) || !strcmp(name, LOOP_CHECKS_FILE) || is_list(name);
}

/* --- backup --------------------------------------------------------------------------------------------------------------------- */

typedef bool copier(struct log *log, const char *from, const char *to);

static bool add_to_copy(struct backup_job *job, copier *copy, const char *from, const char *name)
{
    char *to = mem_printf("%s/%s", job->folder, name), hash[COPY_HASH_BYTES];
    long long bytes;
    bool good = copy(job->log, from, to) && copy_hash(job->log, to, hash, &bytes);
    if (good)
        json_array_append_new(job->files, json_pack("{s:s,s:I,s:s}", "name", name, "bytes", (json_int_t)bytes, "xxh128", hash));
    mem_free(to);
    return good;
}

/* Copies the history files of all months, the newest last, so that the backup includes readings recorded while it runs. */
static bool add_history(struct backup_job *job, const char *folder)
{
    size_t count;
    int *months = month_list(folder, &count);
    bool good = true;
    for (size_t i = 0; i < count && good; i++) {
        char name[MONTH_NAME_BYTES];
        month_name(months[i], name);
        char *from = mem_printf("%s/%s", folder, name);
        good = add_to_copy(job, copy_database, from, name);
        mem_free(from);
    }
    mem_free(months);
    char *journal = mem_printf("%s/" JOURNAL_FILE, folder), *loop_checks = mem_printf("%s/" LOOP_CHECKS_FILE, folder);
    if (good && access(journal, F_OK) == 0)
        good = add_to_copy(job, copy_database, journal, JOURNAL_FILE);
    if (good && access(loop_checks, F_OK) == 0)
        good = add_to_copy(job, copy_file, loop_checks, LOOP_CHECKS_FILE);
    for (int i = 0; i < LISTS && good; i++) {
        char *from = mem_printf("%s/%s", folder, lists[i]);
        good = access(from, F_OK) != 0 || add_to_copy(job, copy_file, from, lists[i]);
        mem_free(from);
    }
    mem_free(journal);
    mem_free(loop_checks);
    return good;
}

/* Copies the files given with --add into the backup and marks them "service":true in the manifest. plantcast-restore, the
   script that restores a service, unpacks them; `plantcast restore` ignores them. */
static bool add_service(struct backup_job *job)
{
    size_t i;
    json_t *path;
    bool good = true;
    json_array_foreach(job->added, i, path)
    {
        const char *from = json_string_value(path);
        good = good && add_to_copy(job, copy_file, from, text_base_name(from)) &&
               json_object_set_new(json_array_get(job->files, json_array_size(job->files) - 1), "service", json_true()) == 0;
    }
    return good;
}

/* Returns the path of the history folder as written in the plant file; NULL: the plant file uses the default folder, next to itself. */
static const char *history_name(const struct plant *plant)
{
    return plant->history.folder ? as_written(plant, plant->history.folder) : NULL;
}

static bool write_manifest(struct backup_job *job, const struct plant *plant)
{
    char now[TIMESTAMP_BYTES];
    timestamp_print(clock_utc_ns() / 1000, now);
    json_t *manifest = json_pack("{s:i,s:s,s:s,s:s?,s:s,s:O}", "version", MANIFEST_VERSION, "plantcast", PLANTCAST_VERSION, "made", now,
                                 "history", history_name(plant), "tags", as_written(plant, plant->files.tags_path), "files", job->files);
    char *path = mem_printf("%s/" MANIFEST, job->folder), *text = json_dumps(manifest, JSON_INDENT(2));
    int error = atomic_file_put(path, text, strlen(text));
    if (error)
        say(path, strerror(-error));
    free(text);
    mem_free(path);
    json_decref(manifest);
    return !error;
}

static void remove_folder(const char *folder)
{
    DIR *dir = opendir(folder);
    for (struct dirent *entry; dir && (entry = readdir(dir));) {
        char *path = mem_printf("%s/%s", folder, entry->d_name);
        unlink(path);
        mem_free(path);
    }
    if (dir)
        closedir(dir);
    rmdir(folder);
}

/* Writes the time of this backup into the history folder; the daemon reports it in /metrics. No-op if the user may only read the folder. */
static void leave_stamp(const char *history)
{
    char *path = mem_printf("%s/" HISTORY_BACKUP_STAMP, history), now[TIMESTAMP_BYTES + 1];
    timestamp_print(clock_utc_ns() / 1000, now);
    strcat(now, "\n");
    if (access(history, W_OK) == 0)
        atomic_file_put(path, now, strlen(now));
    mem_free(path);
}

/* Writes the backup into the folder OUT.part and renames it to OUT once complete, so that a folder named OUT is always a
   complete backup. */
static bool back_up(struct backup_job *job, const struct plant *plant, const char *out)
{
    const char *tags = text_base_name(plant->files.tags_path);
    char *history = history_folder(job, plant), *part = mem_printf("%s.part", out);
    bool good = false;
    job->folder = part;
    if (is_ours(tags) || !strcmp(tags, PLANT_FILE) || !strcmp(tags, MANIFEST))
        say(plant->files.tags_path, "the backup already contains a file with the name of this tag list: rename the tag list");
    else if (access(out, F_OK) == 0)
        say(out, "this folder exists already: choose another folder for the backup with -o");
    else if (mkdir(part, 0700) != 0)
        say(part, strerror(errno));
    else {
        good = add_to_copy(job, copy_file, plant->files.path, PLANT_FILE) && add_to_copy(job, copy_file, plant->files.tags_path, tags) &&
               add_history(job, history) && add_service(job) && write_manifest(job, plant);
        if (good && rename(part, out) != 0)
            good = say(out, strerror(errno));
        if (!good)
            remove_folder(part);
    }
    if (good) {
        if (json_array_size(job->added) == 0) /* else deploy/backup writes the stamp once the backup is verified and copied */
            leave_stamp(history);
        printf("%s: %zu files\n", out, json_array_size(job->files));
    }
    mem_free(history);
    mem_free(part);
    return good;
}

/* --- restore -------------------------------------------------------------------------------------------------------------------- */

/* Returns false if a newer version of Plantcast made the backup, because this program may not know its database formats. */
static bool is_known_version(const char *path, const char *version)
{
    if (!version || strverscmp(version, PLANTCAST_VERSION) <= 0)
        return true;
    fprintf(stderr, "plantcast: %s: this backup was made by Plantcast %s: install version %s or later instead "
                    "of " PLANTCAST_VERSION "\n", path,
            version, version);
    return false;
}

static json_t *read_manifest(const char *folder)
{
    char *path = mem_printf("%s/" MANIFEST, folder);
    size_t bytes;
    char *text = text_read_file(path, MANIFEST_MAX, &bytes);
    json_t *manifest = text ? json_loads(text, 0, NULL) : NULL;
    bool good =
        json_integer_value(json_object_get(manifest, "version")) == MANIFEST_VERSION && json_is_array(json_object_get(manifest, "files"));
    if (!good)
        say(path, text ? "this file is not the file list of a backup, or another version of Plantcast wrote it" : strerror(errno));
    good = good && is_known_version(path, json_string_value(json_object_get(manifest, "plantcast")));
    if (!good && manifest) {
        json_decref(manifest);
        manifest = NULL;
    }
    mem_free(text);
    mem_free(path);
    return manifest;
}

/* Returns false if a file name in the manifest points outside the backup's folder. */
static bool is_plain(const char *name)
{
    return name && *name && *name != '.' && !strchr(name, '/');
}

static bool is_whole(struct backup_job *job)
{
    bool good = true;
    size_t i;
    json_t *file;
    json_array_foreach(job->files, i, file)
    {
        const char *name = json_string_value(json_object_get(file, "name")), *expected = json_string_value(json_object_get(file, "xxh128"));
        char hash[COPY_HASH_BYTES];
        long long bytes;
        if (!is_plain(name) || !expected)
            return say(job->folder, "the file list " MANIFEST " of this backup is damaged: use another backup");
        char *path = mem_printf("%s/%s", job->folder, name);
        if (!copy_hash(job->log, path, hash, &bytes) || strcmp(hash, expected) != 0)
            good = say(path, "this file was changed or damaged after the backup was made: use another backup");
        mem_free(path);
    }
    return good;
}

static bool is_free(const char *path)
{
    struct stat st;
    return lstat(path, &st) != 0 || say(path, "this file exists already, so nothing was restored: move it away or restore to another "
                                              "folder");
}

/* Returns the path to which a backed-up file is restored (mem_free). tags: path of the tag list as the plant file writes it;
   NULL: the tag list is next to the plant file. */
static char *place_of(const char *name, const char *plant_path, const char *history, const char *tags)
{
    if (!strcmp(name, PLANT_FILE))
        return mem_strdup(plant_path);
    if (is_ours(name))
        return mem_printf("%s/%s", history, name);
    const char *path = tags && !strcmp(text_base_name(tags), name) ? tags : name;
    return *path == '/' ? mem_strdup(path) : mem_printf("%.*s%s", (int)(text_base_name(plant_path) - plant_path), plant_path, path);
}

/* Creates a folder if it does not exist. Returns false if `path` is then not a real directory, because a symlink could redirect
   the restored files. A folder created by root gets its parent's owner. */
static bool make_folder(const char *path)
{
    struct stat st, around;
    char *parent = mem_printf("%s/..", path);
    bool made = mkdir(path, 0750) == 0;
    bool good = lstat(path, &st) == 0 && S_ISDIR(st.st_mode);
    if (good && made && geteuid() == 0)
        good = stat(parent, &around) == 0 && lchown(path, around.st_uid, around.st_gid) == 0;
    mem_free(parent);
    return good || say(path, "this folder cannot be created, or a file or symbolic link with its name exists");
}

static bool each_file(struct backup_job *job, const char *plant_path, const char *history, const char *tags, bool put)
{
    size_t i;
    json_t *file;
    bool good = true;
    json_array_foreach(job->files, i, file)
    {
        const char *name = json_string_value(json_object_get(file, "name"));
        if (json_is_true(json_object_get(file, "service")))
            continue;
        char *from = mem_printf("%s/%s", job->folder, name), *to = place_of(name, plant_path, history, tags);
        good = good && (put ? copy_file(job->log, from, to) : is_free(to));
        mem_free(from);
        mem_free(to);
    }
    return good;
}

/* Returns the path of the history folder that the plant file will use once it is restored to plant_path (mem_free). */
static char *future_history(const struct backup_job *job, const json_t *manifest, const char *plant_path)
{
    const char *name = json_string_value(json_object_get(manifest, "history")), *slash = strrchr(plant_path, '/');
    const char *file = slash ? slash + 1 : plant_path, *dot = strrchr(file, '.');
    if (job->history || (name && *name == '/'))
        return mem_strdup(job->history ? job->history : name);
    if (name)
        return mem_printf("%.*s%s", (int)(file - plant_path), plant_path, name);
    char *service = plant_service_folder(plant_path, "history");
    return service ? service : mem_printf("%.*s.history", (int)(dot ? dot - plant_path : (long)strlen(plant_path)), plant_path);
}

static bool check(struct backup_job *job)
{
    json_t *manifest = read_manifest(job->folder);
    job->files = json_object_get(manifest, "files");
    bool good = manifest && is_whole(job);
    json_decref(manifest);
    return good;
}

static bool restore(struct backup_job *job, const char *plant_path)
{
    json_t *manifest = read_manifest(job->folder);
    job->files = json_object_get(manifest, "files");
    char *history = manifest && is_whole(job) ? future_history(job, manifest, plant_path) : NULL;
    const char *tags = json_string_value(json_object_get(manifest, "tags"));
    bool good = history && each_file(job, plant_path, history, tags, false);
    good = good && make_folder(history) && each_file(job, plant_path, history, tags, true);
    if (good)
        printf("%s: this plant file was restored from the backup of %s; the history is in %s\n", plant_path,
               json_string_value(json_object_get(manifest, "made")), history);
    mem_free(history);
    json_decref(manifest);
    return good;
}

/* --- testing a backup ----------------------------------------------------------------------------------------------------------- */

static bool is_database(const char *name)
{
    size_t length = strlen(name);
    return length > 7 && !strcmp(name + length - 7, ".sqlite");
}

/* Compares the hash of each restored file with the manifest. Also copies each database to a temporary file: this makes SQLite
   read every page and report damage that was already in the backup. */
static bool each_restored(struct backup_job *job, const char *plant_path, const char *history)
{
    size_t i;
    json_t *file;
    bool good = true;
    json_array_foreach(job->files, i, file)
    {
        const char *name = json_string_value(json_object_get(file, "name")), *expected = json_string_value(json_object_get(file, "xxh128"));
        if (json_is_true(json_object_get(file, "service")))
            continue;
        char *path = place_of(name, plant_path, history, NULL), *copy = mem_printf("%s.checked", path), hash[COPY_HASH_BYTES];
        long long bytes;
        bool same = copy_hash(job->log, path, hash, &bytes) && !strcmp(hash, expected);
        if (!same)
            say(path, "this restored copy differs from the file in the backup: the backup is unusable, so make a new one");
        good = same && (!is_database(name) || copy_database(job->log, path, copy)) && good;
        unlink(copy);
        mem_free(copy);
        mem_free(path);
    }
    return good;
}

static void say_span(struct backup_job *job, const char *history)
{
    struct history_reader *reader = history_reader_create(job->log, history);
    int64_t first_us, last_us;
    char first[TIMESTAMP_BYTES], last[TIMESTAMP_BYTES];
    if (history_span(reader, &first_us, &last_us)) {
        timestamp_print(first_us, first);
        timestamp_print(last_us, last);
        printf("%s: readings from %s to %s\n", job->folder, first, last);
    }
    history_reader_destroy(&reader);
}

static bool verify_in(struct backup_job *job, const char *aside)
{
    char *plant_path = mem_printf("%s/" PLANT_FILE, aside), *history = mem_printf("%s/history", aside);
    bool good = make_folder(history) && each_file(job, plant_path, history, NULL, true) && each_restored(job, plant_path, history);
    if (good)
        say_span(job, history);
    remove_folder(history);
    remove_folder(aside);
    mem_free(history);
    mem_free(plant_path);
    return good;
}

static bool verify(struct backup_job *job)
{
    json_t *manifest = read_manifest(job->folder);
    job->files = json_object_get(manifest, "files");
    char *aside = mem_printf("%s.verify-XXXXXX", job->folder);
    bool good = manifest && is_whole(job) && (mkdtemp(aside) || say(aside, strerror(errno))) && verify_in(job, aside);
    if (good)
        printf("%s: verified: a trial restore of all %zu files succeeded (backup of %s)\n", job->folder, json_array_size(job->files),
               json_string_value(json_object_get(manifest, "made")));
    mem_free(aside);
    json_decref(manifest);
    return good;
}

/* --- the command line ------------------------------------------------------------------------------------------------------------ */

struct backup_arguments {
    const char *out;    /* -o */
    bool verify, check; /* --verify, --check */
};

/* Parses the command line. Returns -1 to continue, or the exit code. */
static int parse(int argc, char **argv, struct backup_job *job, struct backup_arguments *arguments)
{
    static const struct option options[] = { { "history", required_argument, NULL, 'd' },
                                             { "out", required_argument, NULL, 'o' },
                                             { "verify", no_argument, NULL, 'v' },
                                             { "check", no_argument, NULL, 'c' },
                                             { "add", required_argument, NULL, 'a' },
                                             { "help", no_argument, NULL, 'h' },
                                             { 0 } };
    for (int option; (option = getopt_long(argc, argv, "o:h", options, NULL)) != -1;) {
        switch (option) {
        case 'd': job->history = optarg; break;
        case 'o': arguments->out = optarg; break;
        case 'v': arguments->verify = true; break;
        case 'c': arguments->check = true; break;
        case 'a': json_array_append_new(job->added, json_string(optarg)); break;
        case 'h': print_usage(stdout); return 0;
        default: print_usage(stderr); return 2;
        }
    }
    return -1;
}

static int wrong_arguments(void)
{
    print_usage(stderr);
    return 2;
}

static int back_up_plant(struct backup_job *job, const char *plant_path, const char *out)
{
    struct plant *plant = plant_load_or_print(plant_path);
    bool good = plant && back_up(job, plant, out);
    plant_destroy(&plant);
    return good ? 0 : 1;
}

static int run_command(int argc, char **argv, int (*command)(int argc, char **argv, struct backup_job *job))
{
    struct backup_job job = { .log = log_create(LOG_WARN), .files = json_array(), .added = json_array() };
    /* keeps the new list for json_decref() below: `restore` and `verify` replace job.files by the list inside the manifest that
       they read, which the manifest frees */
    json_t *files = job.files;
    int code = command(argc, argv, &job);
    json_decref(files);
    json_decref(job.added);
    log_destroy(&job.log);
    return code;
}

static int run_backup(int argc, char **argv, struct backup_job *job)
{
    struct backup_arguments arguments = { 0 };
    int code = parse(argc, argv, job, &arguments);
    if (code >= 0)
        return code;
    if (argc - optind != 1 || !arguments.out == !arguments.verify || (arguments.verify && job->history) || arguments.check)
        return wrong_arguments();
    umask(0077); /* only the user who makes the backup may read its files */
    if (!arguments.verify)
        return back_up_plant(job, argv[optind], arguments.out);
    job->folder = argv[optind];
    return verify(job) ? 0 : 1;
}

static int run_restore(int argc, char **argv, struct backup_job *job)
{
    struct backup_arguments arguments = { 0 };
    int code = parse(argc, argv, job, &arguments);
    if (code >= 0)
        return code;
    if (argc - optind != (arguments.check ? 1 : 2) || arguments.out || arguments.verify || json_array_size(job->added) > 0)
        return wrong_arguments();
    job->folder = argv[optind];
    return (arguments.check ? check(job) : restore(job, argv[optind + 1])) ? 0 : 1;
}

/* Returns true if the argument is an instance name of the system service, as `plantcast init` accepts it, rather than a plant
   file's path. */
static bool is_instance(const char *argument)
{
    return argument && *argument != '-' && !strpbrk(argument, "./");
}

int cmd_backup(int argc, char **argv)
{
    if (is_instance(argv[1])) {
        run_beside("-backup", "plantcast-server", argv);
        return 1;
    }
    return run_command(argc, argv, run_backup);
}

int cmd_restore(int argc, char **argv)
{
    bool has_folder = argc > 1 && argv[1][0] != '-', has_plant = argc > 2 && (argv[2][0] != '-' || !strcmp(argv[2], "--history"));
    if (has_folder && !has_plant) {
        run_beside("-restore", "plantcast-server", argv);
        return 1;
    }
    return run_command(argc, argv, run_restore);
}
