/* SPDX-License-Identifier: GPL-3.0-or-later */
/* `plantcast-prep`: converts CAD models to files that plantcastd maps into memory. */
#include <getopt.h>
#include <signal.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/mem.h"
#include "base/system/service_manager.h"
#include "base/system/standard_output.h"
#include "plant/models/model_check.h"
#include "preprocess/child/child_self.h"
#include "preprocess/convert/convert.h"
#include "preprocess/debug/debug_views.h"
#include "preprocess/diff/diff.h"
#include "preprocess/report/distances.h"
#include "preprocess/report/report.h"

enum {
    /* seconds that the current asset may still take after a signal; service managers and container runtimes kill a process
     * after 10 s or more */
    GRACE_S = 5,
    /* seconds after which reading the models, or preparing one asset, counts as hung, so that no more time is requested from
       the service manager */
    ASSET_LIMIT_S = 3600,
};

static const char usage[] =
    "usage: plantcast-prep PLANT.yaml [--output DIR] [--report text|json]\n"
    "       plantcast-prep PLANT.yaml --debug-view[=DIR] [--asset ID] [--sensor TAG]\n"
    "       plantcast-prep --diff OLD NEW [--tolerance M] [--report text|json]\n"
    "       plantcast-prep distances PLANT.yaml --asset ID --sensor TAG [--output DIR]\n"
    "\n"
    "Prepares the models of a plant file for the daemon: extracts the triangles of each asset,\n"
    "projects sensors onto the triangles, and computes distances along the surface from sensors to vertices.\n"
    "Results of an earlier run are reused if their inputs have not changed.\n"
    "Only one run at a time works in an output folder; a second run waits.\n"
    "\n"
    "  --output DIR    output folder for the prepared files (default: PLANT.prepared next to PLANT.yaml)\n"
    "  --report FORMAT text: print the results for all assets; json: print the same results as JSON\n"
    "                  (default: text, only for the assets computed in this run, at most 40 rows)\n"
    "                  preprocess/REPORT.md explains each number. Progress goes to standard error\n"
    "  --debug-view[=DIR]  also write ASSET.glb for each asset to DIR (default: PLANT.debug next to PLANT.yaml)\n"
    "                  ASSET.glb shows the prepared surface in any glTF viewer: sample points, bridges across\n"
    "                  gaps, open edges and interior patches; colours show the distance from a sensor\n"
    "  --asset ID      prepare or print only this asset\n"
    "  --sensor TAG    sensor from which --debug-view and the command `distances` measure distances\n"
    "                  (default: the first sensor on each asset)\n"
    "  --memory MB     refuse a plant that needs more than MB of memory on the machine that will run the\n"
    "                  daemon (default: this machine's); the message says how many triangles would fit\n"
    "  --diff OLD NEW  compare two revisions of a plant; OLD and NEW: plant file or folder of prepared files\n"
    "                  Prints assets that were added, removed, moved or changed, sensors whose surface moved,\n"
    "                  and tags that lost their position (exit status 1 if a tag lost its position)\n"
    "  --tolerance M   with --diff: ignore changes smaller than M metres\n"
    "                  (default: 1 % of the asset's diagonal, but at most 0.01 m)\n"
    "  --help          print this text\n"
    "\n"
    "`distances` prints, for each vertex of the asset, the vertex position and the distances to the sensor\n"
    "along the surface and in a straight line, as CSV: x,y,z,geodesic_m,euclidean_m (metres, plant coordinates).\n"
    "SIGINT and SIGTERM end a run within 5 s. Finished assets are kept; the next run prepares the others.\n"
    "Exit status: 0 success, 1 input or disk error, 2 wrong usage.\n";

struct prep_options {
    bool distances, json, all, debug_view, diff, help;
    const char *plant, *output, *asset, *sensor, *views, *revision; /* revision: plant to compare with */
    double tolerance_m;
    size_t memory_bytes; /* memory of the machine that will serve the plant, bytes; 0: this machine's memory */
};

static atomic_bool interrupted; /* global, because a signal handler takes no argument */

/* Handles the first signal: the current asset is finished if that takes at most GRACE_S; the next run continues from there. The
 * second signal ends the program immediately, which is always safe, because prepared files get their names only when complete.
 * */
static void on_signal(int signal)
{
    (void)signal;
    atomic_store(&interrupted, true);
    alarm(GRACE_S);
}

static void give_up(int signal)
{
    static const char words[] =
        "\nplantcast-prep: interrupted: finished assets are kept, unfinished assets were discarded; run plantcast-prep again to continue\n";
    (void)signal;
    if (write(STDERR_FILENO, words, sizeof(words) - 1) < 0)
        _exit(1);
    _exit(1);
}

static void catch_signals(void)
{
    struct sigaction action = { .sa_handler = on_signal, .sa_flags = (int)SA_RESETHAND }, last = { .sa_handler = give_up };
    sigaction(SIGALRM, &last, NULL);
    sigaction(SIGINT, &action, NULL);
    sigaction(SIGTERM, &action, NULL);
}

static int wrong_use(const char *what, const char *about)
{
    fprintf(stderr, "plantcast-prep: %s%s\n\n%s", what, about, usage);
    return 2;
}

/* Parses the command line's options. Returns 0, or the exit status to end with. */
static int read_options(int argc, char **argv, struct prep_options *options)
{
    static const struct option known[] = { { "output", required_argument, NULL, 'o' },
                                           { "report", required_argument, NULL, 'r' },
                                           { "diff", no_argument, NULL, 'D' },
                                           { "tolerance", required_argument, NULL, 't' },
                                           { "debug-view", optional_argument, NULL, 'd' },
                                           { "asset", required_argument, NULL, 'a' },
                                           { "sensor", required_argument, NULL, 's' },
                                           { "memory", required_argument, NULL, 'm' },
                                           { "help", no_argument, NULL, 'h' },
                                           { 0 } };
    int c;
    long memory_mb;
    char *end;
    while ((c = getopt_long(argc, argv, "ho:r:", known, NULL)) != -1) {
        switch (c) {
        case 'o': options->output = optarg; break;
        case 'D': options->diff = true; break;
        case 't':
            options->tolerance_m = strtod(optarg, &end);
            if (end == optarg || *end || !(options->tolerance_m > 0 && options->tolerance_m < 1e6))
                return wrong_use("--tolerance: expected a number of metres, not ", optarg);
            break;
        case 'd':
            options->debug_view = true;
            options->views = optarg;
            break;
        case 'm':
            memory_mb = strtol(optarg, &end, 10);
            if (end == optarg || *end || memory_mb < 1 || memory_mb > 1 << 24)
                return wrong_use("--memory: expected a number of MB, not ", optarg);
            options->memory_bytes = (size_t)memory_mb << 20;
            break;
        case 'a': options->asset = optarg; break;
        case 's': options->sensor = optarg; break;
        case 'h': options->help = true; break;
        case 'r':
            if (strcmp(optarg, "json") != 0 && strcmp(optarg, "text") != 0)
                return wrong_use("--report: expected text or json, not ", optarg);
            options->json = strcmp(optarg, "json") == 0;
            options->all = !options->json;
            break;
        default: return wrong_use("", "unknown option");
        }
    }
    if (options->help)
        return 0;
    if (optind < argc && strcmp(argv[optind], "distances") == 0) {
        options->distances = true;
        optind++;
    }
    if (optind >= argc)
        return wrong_use("", "expected a plant file");
    options->plant = argv[optind++];
    if (options->diff && optind >= argc)
        return wrong_use("", "--diff needs two arguments: the old plant and the new plant");
    if (options->diff)
        options->revision = argv[optind++];
    if (optind < argc)
        return wrong_use("too many arguments: ", argv[optind]);
    if (options->distances && (!options->asset || !options->sensor))
        return wrong_use("", "the command 'distances' requires --asset and --sensor");
    if (options->tolerance_m > 0 && !options->diff)
        return wrong_use("", "--tolerance requires --diff");
    if (!options->distances && !options->debug_view && options->sensor)
        return wrong_use("", "--sensor requires the command 'distances' or --debug-view");
    return 0;
}

static bool run_distances(const struct prep_options *options, struct log *log, struct workers *workers, const struct plant *plant,
                          const char *folder, struct diag *diag)
{
    struct prepare prepare;
    int asset = plant_find_asset(plant, options->asset), tag = plant_find_tag(plant, options->sensor);
    if (asset < 0)
        diag_error(diag, plant->files.path, 0, 0, "--asset: this plant file has no asset %s", options->asset);
    if (tag < 0)
        diag_error(diag, plant->files.tags_path, 0, 0, "--sensor: this tag list has no tag %s", options->sensor);
    if (asset < 0 || tag < 0)
        return false;
    struct prepare_params params = { .folder = folder, .only = options->asset };
    bool good = prepare_run(&prepare, log, workers, plant, &params, diag) && distances_print(&prepare, folder, asset, tag, stdout, diag);
    prepare_finish(&prepare);
    return good;
}

/* Checks the plant's models and nodes by reading only the headers of model files, so that errors are printed long before the
 * models are read completely. Assets without errors are prepared anyway; the errors of assets whose preparation is tried are
 * printed again at the end. Returns false if the plant is too large for the memory. */
static bool say_early(const struct plant *plant, size_t memory_bytes)
{
    struct diag diag = { 0 }, errors = { 0 };
    bool fits = models_check(plant, memory_bytes, &diag, NULL);
    for (size_t i = 0; i < diag.count; i++)
        if (diag.items[i].severity == DIAG_ERROR)
            diag_copy(&errors, &diag.items[i]);
    diag_print(&errors, stderr);
    if (errors.count && fits)
        fprintf(stderr, "plantcast-prep: continuing with the assets that have no errors\n");
    fflush(stderr);
    diag_finish(&errors);
    diag_finish(&diag);
    return fits;
}

static bool run_all(const struct prep_options *options, struct log *log, struct workers *workers, const struct plant *plant,
                    const char *folder, struct service_patience *patience, struct diag *diag)
{
    struct prepare prepare;
    struct prepare_params params = {
        .folder = folder, .only = options->asset, .progress = stderr, .patience = patience, .stop = &interrupted
    };
    if (options->asset && plant_find_asset(plant, options->asset) < 0) {
        diag_error(diag, plant->files.path, 0, 0, "--asset: this plant file has no asset %s", options->asset);
        return false;
    }
    if (!say_early(plant, options->memory_bytes))
        return false;
    bool good = prepare_run(&prepare, log, workers, plant, &params, diag);
    if (options->json)
        good = report_json(&prepare, stdout) && good;
    else
        report_text(&prepare, options->all, stdout);
    prepare_finish(&prepare);
    if (good && options->debug_view) {
        char *views = options->views ? mem_strdup(options->views) : debug_views_folder(plant);
        struct debug_views_params wanted = { .folder = views, .asset = options->asset, .sensor = options->sensor, .say = stderr };
        good = debug_views_write(log, workers, plant, &wanted, diag);
        mem_free(views);
    }
    return good;
}

static bool run_diff(const struct prep_options *options, struct diag *diag)
{
    struct diff diff;
    bool good = diff_run(&diff, options->plant, options->revision, options->tolerance_m, diag);
    if (good && options->json)
        good = diff_json(&diff, stdout);
    else if (good)
        diff_text(&diff, stdout);
    good = good && diff.orphan_count == 0 && diag->errors == 0;
    diff_finish(&diff);
    return good;
}

/* Confines this process, because models are untrusted files: it may read the plant's files and write the prepared ones, but
 * cannot read keys and tokens. */
static bool confine_self(const struct plant *plant, const char *folder, char **argv, struct diag *diag)
{
    static const char beside[] = ".yaml .yml .csv .glb .gltf .bin .buffer .dat .png .jpg .jpeg .webp .ktx .ktx2 .basis .dds .gif .bmp .tga "
                                 ".tif .tiff .exr .hdr";
    struct child_paths paths = { 0 };
    bool notifies = getenv("NOTIFY_SOCKET") != NULL;
    mkdir(folder, 0777); /* ignore a failure to create the folder of prepared files: writing the first file will report it */
    child_paths_add(&paths, "/proc/self/exe", CONFINE_EXECUTE);
    child_paths_add_modules(&paths);
    child_paths_add(&paths, folder, CONFINE_WRITE);
    child_paths_add(&paths, plant->files.tags_path, CONFINE_READ);
    child_paths_add_beside(&paths, plant->files.path, beside);
    for (size_t i = 0; i < plant->asset_count; i++)
        if (i == 0 || strcmp(plant->assets[i].model, plant->assets[i - 1].model) != 0) {
            child_paths_add(&paths, plant->assets[i].model, CONFINE_READ);
            child_paths_add_beside(&paths, plant->assets[i].model, beside);
        }
    for (size_t i = 0; i < plant->group_count; i++)
        child_paths_add(&paths, plant->groups[i].gp.fit, CONFINE_READ);
    if (notifies)
        /* service_patience, which asks the service manager for more time, needs /proc: it reads there whether other processes
           are active */
        child_paths_add(&paths, "/proc", CONFINE_READ);
    int status = child_self_confine(&paths, notifies, argv);
    child_paths_finish(&paths);
    if (status != 0)
        diag_error(diag, plant->files.path, 0, 0, "plantcast-prep cannot restrict its own file access (sandbox): %s", strerror(-status));
    return status == 0;
}

static bool run_plant(const struct prep_options *options, char **argv, struct diag *diag)
{
    struct plant *plant = plant_load(options->plant, diag);
    if (!plant)
        return false;
    /* ask the service manager for more time, in case the daemon's start waits for this preparation */
    struct service_patience *patience = service_patience_begin("preparing the plant", ASSET_LIMIT_S);
    char *folder = options->output ? mem_strdup(options->output) : plant_prepared_folder(plant);
    bool confined = child_self_confined(), good = confined || convert_run(plant, folder, stderr, diag);
    if (good && !confined && !options->distances && !options->debug_view) {
        service_patience_end(&patience);
        good = confine_self(plant, folder, argv, diag);
        patience = service_patience_begin("preparing the plant", ASSET_LIMIT_S);
    }
    struct log *log = log_create(LOG_INFO);
    struct workers *workers = workers_create(0);
    if (good && options->distances)
        good = run_distances(options, log, workers, plant, folder, diag);
    else if (good)
        good = run_all(options, log, workers, plant, folder, patience, diag);
    service_patience_end(&patience);
    mem_free(folder);
    workers_destroy(&workers);
    plant_destroy(&plant);
    log_destroy(&log);
    return good;
}

int main(int argc, char **argv)
{
    struct prep_options options = { 0 };
    struct diag diag = { 0 };
    int status = read_options(argc, argv, &options);
    if (status != 0)
        return status;
    if (options.help) {
        fputs(usage, stdout);
        return standard_output_end("plantcast-prep", 0);
    }
    catch_signals();
    bool good = options.diff ? run_diff(&options, &diag) : run_plant(&options, argv, &diag);
    diag_print(&diag, stderr);
    diag_finish(&diag);
    return standard_output_end("plantcast-prep", good ? 0 : 1);
}
