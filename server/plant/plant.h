/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A plant, loaded from its plant file (YAML) and tag list (CSV) and checked for syntax and meaning. Immutable once loaded. Call
   from any thread. plantcastd, plantcast-prep and plantcast-sim all use it. */
#ifndef PLANT_PLANT_H
#define PLANT_PLANT_H
#include <math.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "base/color/colormap.h"
#include "base/text/diag.h"
#include "plant/tags/units.h"

/* maximum distance of positions from the plant's origin in metres; large enough for survey coordinates (UTM), whose northings reach 10,000
   km */
#define PLANT_MAX_M 1e7

enum interpolation {
    INTERPOLATION_SHEPARD,
    INTERPOLATION_PAPER,
    INTERPOLATION_HARMONIC,
    INTERPOLATION_FIN,
    INTERPOLATION_GP,
    INTERPOLATIONS
};
/* DISTANCE_HEAT: geodesic distances by the heat method (Crane et al., 2013), as in Kim & Suh, Electronics 2025, 14(15), 2938 */
enum distance_mode { DISTANCE_GEODESIC, DISTANCE_EUCLIDEAN, DISTANCE_HEAT, DISTANCES };
/* content of a picture around a sensor whose reading is Bad: nothing, or the field of neighbouring sensors */
enum fill_mode { FILL_NONE, FILL_NEIGHBOURS };
/* content of a client's first picture: values, or values relative to their alarm limits (operator's display) */
enum plant_show { PLANT_SHOW_VALUE, PLANT_SHOW_OPERATOR };
/* initial display state of an asset: shown, ghosted (outline only) or hidden */
enum plant_start { PLANT_START_SHOWN, PLANT_START_GHOST, PLANT_START_HIDDEN };
enum { PLANT_STARTS = 4096 }; /* number of assets, from the first in the plant file on, that can be hidden or ghosted individually */
enum axis { AXIS_Y, AXIS_Z }; /* upward axis */
enum data_type {
    DATA_BIT,
    DATA_INT16,
    DATA_UINT16,
    DATA_INT32,
    DATA_UINT32,
    DATA_FLOAT32,
    DATA_INT64,
    DATA_UINT64,
    DATA_FLOAT64,
    DATA_BCD /* 4 digits, one register */,
    DATA_LBCD /* 8 digits, two registers */
};
/* Order in which the bytes of a value A B C D (A most significant) arrive from a Modbus device. For 64 bits: CDAB reverses the order of the
   registers, BADC swaps the bytes within each register, DCBA does both. NONE: not stated. */
enum byte_order { BYTE_ORDER_NONE, BYTE_ORDER_ABCD, BYTE_ORDER_CDAB, BYTE_ORDER_BADC, BYTE_ORDER_DCBA };
/* Modbus tables in the order of their standard numbering; they are read with function codes 1, 2, 4 and 3 */
enum register_table { TABLE_COIL, TABLE_DISCRETE, TABLE_INPUT, TABLE_HOLDING };
enum scaling { SCALING_NONE, SCALING_LINEAR, SCALING_SQUARE_ROOT };
enum limit { LIMIT_LL, LIMIT_L, LIMIT_H, LIMIT_HH, LIMIT_COUNT };
enum alarm_mode { /* which system manages the alarms */
                  /* another system manages alarms: this daemon watches and shows limits, but its users cannot acknowledge alarms */
                  ALARMS_DISPLAY,
                  ALARMS_MIRROR, /* another system manages alarms, and this daemon reads that system's alarm bits */
                  ALARMS_LOCAL   /* this daemon */
};
enum { ALARM_PRIORITIES = 4, ALARM_PRIORITY_DEFAULT = 2 };
extern const char *const plant_limit_names[LIMIT_COUNT];

struct plant_view { /* initial camera of a client; positions in metres, in the plant's coordinate frame */
    bool set;
    double eye_m[3], target_m[3], fov_deg;
};

enum { PLANT_PROPERTIES = 32 };
struct plant_property {
    char *name, *text;
};

struct plant_asset {
    char *id, *tag, *description; /* tag defaults to id */
    char *area;                   /* part of the plant that lists show the asset under; "": none */
    char *model;                  /* path of the model file; a relative path is relative to the plant file's folder */
    char *nodes;   /* node patterns (nodes.h), one per line; each matching node is taken with its sub-tree. NULL: the whole model */
    double unit_m; /* length of a model unit in metres, including the scale of the asset's placement */
    enum axis up;  /* upward axis of the model */
    /* maximum width in metres of surface gaps that distances along the surface cross as if closed; 0: chosen from the model */
    double tolerance_m;
    /* transform from the asset's coordinate frame (Z up) to the plant's, column-major; rotation and translation only: both frames are in
       metres */
    double placement[16];
    enum plant_start start;
    double thickness_m;                /* thickness of the asset's wall in metres; 0: not stated */
    double conductivity;               /* W/(m K) */
    double heat_transfer;              /* heat transfer coefficient from the asset's wall to its surroundings, W/(m2 K) */
    /* true: the columns X, Y, Z of the asset's tags are in the asset's coordinate frame; false: in the plant's */
    bool sensors_in_asset_frame;
    struct plant_property *properties; /* properties of the asset in the plant file, in the order of the file */
    size_t property_count;
    int line;
};

struct plant_alarm_settings { /* alarm settings of a group or of a tag: when alarms are raised and cleared */
    double deadband;          /* engineering units */
    double on_delay_s, off_delay_s;
    /* priority of the alarms LL and HH, from 1 (most urgent) to ALARM_PRIORITIES; L and H get the next lower priority */
    int priority;
    bool latch; /* true: the alarm is latched: it stays until an operator resets it, even if the value returns to normal */
};

struct plant_mirror {  /* for a tag that is an alarm bit of another system (`mirror`): which alarm the bit reports */
    int tag;           /* index of the tag whose alarm the bit reports, or -1 */
    int limit;         /* limit (LL, L, H, HH) whose alarm the bit reports, as enum limit; LIMIT_COUNT: the alarm belongs to no limit */
    bool acknowledged; /* true: the bit means "acknowledged"; false: the bit means "alarm present" */
};

struct plant_gp { /* parameters of the interpolation `gp` */
    /* range_m: correlation length in metres; noise, deviation: standard deviations of a reading's noise and of the field (interpolated
       values), in the group's unit; NaN: plantcast-prep determines it from readings */
    double range_m, noise, deviation;
    char *fit; /* path of a file of readings, from which plantcast-prep determines those parameters of `gp` that are NaN; NULL: none */
};

enum { PLANT_BREAKS = 16, PLANT_ISOLINES = 32 };
/* least width of a colour scale's range, as a fraction of the larger absolute value of its ends: values are stored as 32-bit floats, which
   differ by 6e-8 */
#define PLANT_LEAST_RELATIVE_WIDTH 1e-6
/* least width of a colour scale's range, in the group's unit: renderers multiply by the reciprocal of the width, which must be finite as a
   32-bit float */
#define PLANT_LEAST_WIDTH 1e-18
/* least lower end of a logarithmic colour scale, in the group's unit */
#define PLANT_LEAST_LOG 1e-18

/* Returns whether [min, max] can be the range of a colour scale. */
static inline bool plant_range_is_wide(double min, double max)
{
    return max - min >= fmax(PLANT_LEAST_WIDTH, PLANT_LEAST_RELATIVE_WIDTH * fmax(fabs(min), fabs(max)));
}

struct plant_group {
    char *id, *quantity, *unit;
    /* true (key `units: as-written`): values are taken to be in the group's unit, even if the tag list states another unit */
    bool as_written;
    double min, max;
    double limits[LIMIT_COUNT]; /* default alarm limits for the group's tags that state none; NaN: no limit */
    struct plant_alarm_settings alarm_settings;
    enum interpolation interpolation;
    enum distance_mode distance;
    double strength, decay, power;
    double radius_m;   /* radius R in Algorithm 1 of Kim & Suh (field/field.h), metres; 0: the largest distance on the asset */
    double reach_m;    /* distance in metres beyond which a sensor has no influence; INFINITY: no limit */
    unsigned prepared; /* bit mask of the interpolations that plantcast-prep computes (plant/influence.h), including the group's own */
    double disc_m;     /* radius in metres of the disc that represents a sensor in the interpolations harmonic, fin and gp */
    /* temperature of an asset's surroundings, used by the interpolation `fin`, in the group's unit; NaN: the plant file does
       not state it */
    double ambient;
    bool directed;     /* true: some tags of the group have a direction (such as the flow of air), which is shown with arrows */
    /* true (key `geodesic: heat`): plantcast-prep also computes distances along the surface by the heat method, as in Kim & Suh */
    bool heat;
    struct plant_gp gp;
    /* Size of the hot spots that `show: blind` considers: distance in metres from a spot's centre at which its excess
       temperature has fallen by the factor exp(-1/2). `show: blind` shows how strong a spot of this size must be for a sensor
       to notice it. */
    double hot_spot_m;
    bool cuts_singles; /* true (key `singles: cut`): plantcast-prep subdivides triangles even of assets with only one sensor of the group */
    enum fill_mode fill;
    bool log;                    /* true (`scale: log`): the colour scale is logarithmic, which requires min > 0 */
    /* ascending values at which one colour band ends and the next begins, for pictures in bands instead of continuous colours */
    double breaks[PLANT_BREAKS];
    double isolines[PLANT_ISOLINES];
    int break_count, isoline_count;
    int line;
};

enum { PLANT_COLORMAPS = 16 };

enum transport { TRANSPORT_TCP, TRANSPORT_RTU_TCP /* RTU frames over TCP */, TRANSPORT_RTU /* a serial line */ };
enum { PLANT_HOSTS = 4 };
#define PLANT_NEVER_STALE_S 1e9
enum mqtt_payload { MQTT_NUMBER /* text: one number */, MQTT_JSON, MQTT_SPARKPLUG /* Sparkplug B */ };

struct plant_mqtt { /* MQTT settings of a source or of `publish`; omitted texts are NULL */
    enum mqtt_payload payload;
    int protocol;    /* version of the MQTT protocol: 4 means MQTT 3.1.1, and 5 means MQTT 5 */
    bool persistent; /* true: persistent session: the broker keeps messages while this daemon is disconnected */
    int qos, keepalive_s;
    char *client_id;
    bool has_tls;
    /* PEM files for TLS: CA certificates (NULL: the system's trusted ones), and the daemon's own certificate and key (NULL:
       none) */
    char *ca, *certificate, *key;
    char *will;                   /* topic of the last will: if the connection breaks, the broker publishes "offline" there */
    char *topic;                  /* topic template for tags whose address has no topic */
    char *value, *time, *quality; /* JSONPaths that find value, time and quality in a JSON message */
    bool will_stays;              /* true: the last will is a retained message, which new subscribers get too */
    /* true: the daemon may ask Sparkplug nodes for their birth certificates (lists of all their metrics); it publishes nothing
       else to this broker */
    bool rebirth;
};

enum opcua_policy { OPCUA_BEST /* best security policy that the server offers */, OPCUA_AES256, OPCUA_BASIC256, OPCUA_AES128, OPCUA_NONE };

struct plant_opcua {                   /* OPC UA settings of a source; omitted texts are NULL */
    bool has_security;                 /* true: the plant file has the key `security`; a source without that key is refused */
    enum opcua_policy policy;          /* security policy. Messages are signed and encrypted (SignAndEncrypt), except with OPCUA_NONE */
    char *certificate, *key;           /* files with the daemon's own certificate and key, PEM or DER */
    char *trusted;                     /* folder with the certificates of trusted OPC UA servers, and revocation lists */
    char *server_name;                 /* host name in the server's certificate, if it differs from the host */
    /* files with certificate and key of the user that the daemon signs in as, instead of a login file */
    char *user_certificate, *user_key;
    char *path;                        /* path of the endpoint URL */
    char *name_space;                  /* namespace URI that applies to tags whose address states no namespace */
    int queue;                         /* number of values per node that the OPC UA server queues between two messages to the daemon */
    /* smallest change of a value that the OPC UA server reports: absolute, or in percent of the node's range (EURange); 0: every change */
    double deadband, deadband_percent;
};

struct plant_source {
    char *id, *kind; /* "modbus", "replay", "mqtt" or "opcua" */
    enum transport transport;
    char *hosts[PLANT_HOSTS]; /* redundant hosts of one device: if a host does not answer, the next one is tried */
    int host_count;
    char *device;                      /* serial device */
    int baud, parity, stop_bits;       /* parity: 'N', 'E' or 'O' */
    int port, unit;                    /* unit: Modbus unit identifier */
    /* milliseconds; poll_ms: between two readings of a value; timeout_ms: after which an answer counts as missing; pause_ms:
       between an answer and the next request */
    int poll_ms, timeout_ms, pause_ms;
    int connect_delay_ms;              /* pause in milliseconds between connecting to the device and the first request */
    bool close_between_polls;          /* one request per connection */
    int max_registers, max_bits;       /* maximum number of registers, or of bits, in one Modbus request */
    /* maximum number of unneeded registers (or bits) between the registers of two tags; with more in between, two requests are
       sent */
    int max_gap;
    enum byte_order byte_order;
    /* number that addresses such as 40001 give to a device's first register: 0 or 1; base_stated: true: the plant file states
       it */
    int address_base;
    bool base_stated;
    /* heartbeat: name of a tag of this source whose value must keep changing; otherwise the device is taken to have stopped. NULL: none */
    char *heartbeat;
    int heartbeat_tag;  /* index of the heartbeat tag in the plant; -1: none */
    double heartbeat_s; /* maximum time in seconds between two changes of the heartbeat; 0: no heartbeat */
    char *file;         /* path of the CSV file that a replay source plays */
    double speed;
    bool loop;
    char *login; /* path of a file with the user name on the first line and the password on the second */
    struct plant_mqtt mqtt;
    struct plant_opcua opcua;
    bool simulated; /* true: a simulator provides the readings of this source, so they are not measured */
    int line;
};

/* The broker to which readings and alarms are published. */
struct plant_publish {
    /* connection to the broker; of its members, only those for the broker's address and the daemon's identity are used */
    struct plant_source broker;
    char *prefix;               /* beginning of all topics that the daemon publishes; itself begins with plantcast/ */
    double every_s;
};

/* A PostgreSQL database that receives a copy of the history. */
struct plant_postgres {
    char *url;   /* libpq URL without a password; NULL: no database */
    /* path of a file with the user name on the first line and the password on the second; NULL: libpq finds the login itself */
    char *login;
    char *schema;
    double spool_points; /* maximum number of points that are kept on this machine's disk while the database cannot be reached */
};

struct plant_history {
    bool off;
    char *folder; /* folder of the history; NULL: the default, FOLDER/NAME.history (plant_history_folder()) */
    double keep_days, keep_gb;
    double deadband_percent; /* deadband in percent of a tag's span, for tags without a deadband of their own */
    double override_s;       /* maximum time in seconds between two recorded points of a tag */
    struct plant_postgres postgres;
};

/* Sentinel: a raw value, given as bits or as a number, by which a device reports that no sensor is connected. */
struct plant_sentinel {
    bool is_bits;
    uint64_t bits;
    double number;
};

/* Quality tag: another tag that tells whether this tag's value is valid. The value is valid if ((value of the quality tag & mask) == want)
   != negate. */
struct plant_quality_tag {
    int tag;             /* index of the other tag */
    uint64_t mask, want; /* mask 0: no quality tag */
    bool negate;
};

enum { PLANT_SENTINELS = 4 };
struct opcua_deadband { /* smallest change of a node that the OPC UA server reports */
    double value; /* the smallest change; 0: every change is reported; NaN (only for a tag): the deadband of the tag's source applies */
    bool percent; /* true: in percent of the node's range (EURange); false: in the node's unit */
};

struct tag_signal { /* how a tag's value is read from its device: address and encoding */
    char *address;  /* address as written in the tag list: a register, a series name, a topic, or = and an expression */
    /* topic, path: the two parts of the address. MQTT: the full topic, and the path of the value in its payload ("": the
       source's default). Sparkplug: GROUP/NODE[/DEVICE], and the metric. OPC UA: the namespace URI, and an identifier such as
       s=NAME. Other sources: NULL. */
    char *topic, *path;
    int element;     /* index of the element in an OPC UA array; -1: the node's value is not an array */
    int modbus_unit; /* Modbus unit identifier of the device; -1: the source's */
    enum register_table table;
    int register_index; /* number of the first register, counted from 0 as in Modbus messages */
    int bit;            /* number of the bit within the register; -1: the value is the whole register */
    enum data_type type;
    /* byte order. Values of 32 and 64 bits always have one; values of 16 bits and bits of a register have NONE (standard order) unless the
       tag's row states one */
    enum byte_order byte_order;
    int scan_ms; /* interval in milliseconds between readings of the tag; 0: the source's poll_ms */
    struct opcua_deadband opcua_deadband;
};

struct tag_scale { /* conversion from the raw value to the tag's unit */
    enum scaling kind;
    double raw_low, raw_high, scaled_low, scaled_high; /* range of raw values, and the range of values in own_unit that it is scaled to */
    bool has_range;                                    /* true: the range scaled_low to scaled_high is the instrument's measuring range */
    /* true: raw_low and raw_high are 4 and 20 mA, so NAMUR NE 43 applies to currents outside of that range (overrange or broken wire) */
    bool ne43;
    struct plant_sentinel sentinels[PLANT_SENTINELS];
    int sentinel_count;
    bool negate;
    /* unit of the values at the tag's address and of scaled_low and scaled_high: the unit in the tag's row; if the row has
       none, the tag's unit */
    char *own_unit;
    struct unit_change change; /* conversion of values from own_unit to the unit in which the plant shows the tag */
};

struct tag_place { /* position of a tag's sensor on its asset */
    /* `Place: equipment`: the exact position on the asset is unknown; the reading represents the whole asset (field/field.h) */
    bool assumed;
    bool has_position;    /* true: position_m is set; false: `node` gives the position or, without a node, the middle of the asset */
    double position_m[3]; /* position in metres, in the coordinate frame that the asset's settings name */
    char *node;           /* name of the model node that gives the position, or NULL */
    /* id of a missing asset: the tag's row names it, but no such asset exists (plant_load_with_orphans()); NULL: the asset
       exists */
    char *lost_asset;
};

struct tag_validity {                 /* settings that decide from age, changes and a quality tag whether a tag's reading is good */
    /* age in seconds at which the tag's reading becomes stale. Default: three poll intervals, at least 5 s; OPC UA and Sparkplug: never */
    double stale_s;
    bool states_stale;                /* the row states stale_s */
    double flatline_s;                /* seconds without any change after which the tag's value is uncertain; 0: never */
    struct plant_quality_tag quality; /* quality tag: another tag that tells whether this tag's reading is valid */
};

struct tag_alarms {
    double limits[LIMIT_COUNT];           /* alarm limits that apply to the tag: its own, or those of its group; NaN: no limit */
    struct plant_alarm_settings settings; /* alarm settings that apply to the tag: its own, or those of its group */
    /* index of a tag with one bit: while the bit is 1, the tag's alarms are suppressed, as the plant's designers intended; -1:
       none */
    int suppressed_by;
    struct plant_mirror mirror;
};

struct tag_direction { /* direction of the measured quantity, such as an air flow; pictures show it as an arrow */
    int tags[3];       /* indices of the tags that hold the direction: its components along X, Y and Z of the plant, or a bearing */
    int count;         /* number of tags in `tags`: 0: the value has no direction; 1: a bearing in degrees; 3: components */
};

struct plant_tag {
    char *name, *description;
    char *unit; /* unit of the tag's readings, limits and deadbands: the group's unit, or, for a tag without a group, the unit in its row */
    int source, group, asset; /* index, or -1 */
    struct tag_signal signal;
    struct tag_scale scale;
    struct expression *expression; /* expression of a derived tag; NULL for other tags */
    struct tag_place place;
    /* parameters of the interpolation, strength s and decay o (Algorithm 1 of Kim & Suh, field/field.h): the tag's own values
       if its row states any, otherwise those of its group */
    double strength, decay;
    struct tag_validity validity;
    struct tag_alarms alarms;
    /* largest deviation of recorded history from the readings, in the tag's unit; NaN: the history's default */
    double deadband;
    struct tag_direction direction;
    int line, column; /* position of the tag's name in the tag list's file; both count from 1 */
};

enum { PLANT_ENVIRONMENTS = 8 };
struct plant_environment { /* panorama image whose light falls on the plant in pictures */
    char *name;            /* name of the image file without its extension; never "sky" */
    char *path;
};

enum { PLANT_LINKS = 16 };
struct plant_link { /* template of a link to another system's page about an asset or a tag */
    char *name;
    char *url; /* http or https URL; placeholders in braces, such as a tag's name, are replaced by escaped values (PLANT.md) */
    bool of_tags;
};

struct plant_conversion { /* conversion by which plantcast-prep makes a model: it runs another program, which writes a glTF file */
    char *model;          /* path of the glTF file that the program must write */
    char *from, *command; /* input file, and the command */
    char *also;           /* glob(3) pattern of further input files; NULL: none */
    double timeout_s;
    int line;
};

struct plant_files {
    char *path, *folder; /* path of the plant file, and its folder without trailing slash */
    char *tags_path;
    char hash[17];       /* hash of plant file and tag list in hexadecimal, which identifies the configuration */
    char plant_hash[17], tags_hash[17]; /* hash of the plant file alone, and of the tag list alone, in hexadecimal */
    bool keeps_orphans;  /* true while loading: tags whose asset does not exist are accepted (plant_load_with_orphans()) */
    bool without_models; /* true while loading: missing model files are accepted (plant_load_without_models()) */
};

struct plant_display { /* content of a client's first picture, and what users can choose */
    struct plant_view view;
    enum plant_show show;
    /* true: clients get no depth grids, so the page cannot reproject a picture to the present camera until the next one arrives */
    bool no_reprojection;
    struct plant_environment environments[PLANT_ENVIRONMENTS]; /* environments (panoramas); the first one is the default */
    size_t environment_count;
    struct plant_link links[PLANT_LINKS];
    size_t link_count;
    struct colormap colormaps[PLANT_COLORMAPS]; /* colour maps that were read from images (plant/colormaps.h) */
    size_t colormap_count;
};

struct plant_screens { /* the plant file's views, tours, other plants and walls (plant/walls/wall.h) */
    struct named_view *views;
    struct tour *tours;
    struct other_plant *other_plants;
    struct wall *walls;
    size_t view_count, tour_count, other_plant_count, wall_count;
};

struct plant {
    struct plant_files files;
    char *name, *time_zone; /* name of the plant, and IANA name of its time zone; default UTC */
    enum axis up;           /* axis of the plant's coordinate frame that points up */
    struct plant_display display;
    struct plant_screens screens;
    struct plant_conversion *conversions;
    size_t conversion_count;
    struct plant_history history;
    enum alarm_mode alarms;
    struct plant_publish *publish; /* NULL: no publishing */
    struct plant_notify *notify;   /* recipients of alarm notifications (plant/sections/notification.h); NULL: none */
    struct plant_asset *assets;
    struct plant_group *groups;
    struct plant_source *sources;
    struct plant_tag *tags;
    size_t asset_count, group_count, source_count, tag_count;
    /* indices sorted for binary search: of assets by id, and of tags by name; assets_by_id is NULL until the whole file is read */
    int *assets_by_id, *tags_by_name;
    /* indices of the derived tags (computed from other tags), each after the tags in its expression */
    int *derived;
    size_t derived_count;
};

/* Loads a plant file and its tag list. Errors and warnings go to diag. Returns NULL if there was any error. */
struct plant *plant_load(const char *path, struct diag *diag);
/* Computes the hash that files.hash would have if the plant were loaded again now: of the plant file and tag list on disk. */
void plant_hash_on_disk(const struct plant *plant, char hash[17]);
/* Loads a plant like plant_load(), and prints errors and warnings to standard error. */
struct plant *plant_load_or_print(const char *path);
/* Loads a plant like plant_load_or_print(), but does not require the model files: for commands that need no models. */
struct plant *plant_load_without_models(const char *path);
/* Loads a plant like plant_load(), but accepts tags whose asset does not exist. Such tags get no asset, and lost_asset is set. */
struct plant *plant_load_with_orphans(const char *path, struct diag *diag);
void plant_destroy(struct plant **plant); /* Frees a plant and sets *plant to NULL; accepts a pointer to NULL. */

/* The plant_find_...() functions return an index; -1: there is no such item. */
int plant_find_asset(const struct plant *plant, const char *id);
int plant_find_group(const struct plant *plant, const char *id);
/* Returns the index of an environment (lighting of pictures) by name: 0 for "sky", 1 for the plant's first panorama, and so on;
   -1: unknown. */
int plant_find_environment(const struct plant *plant, const char *name);
int plant_find_tag(const struct plant *plant, const char *name);
/* Returns the unit of a tag's readings; "": it has none, or `tag` is -1. */
const char *plant_tag_unit(const struct plant *plant, int tag);
/* Returns the interval in milliseconds at which a tag's source reads the tag: the tag's own scan_ms, else the source's poll_ms;
   1000 for a tag without a source. */
int plant_tag_scan_ms(const struct plant *plant, const struct plant_tag *tag);
/* Returns whether a tag's source sends values only when they change, and reports the loss of values itself. OPC UA servers do
   so, and Sparkplug nodes, which have death certificates. */
bool plant_tag_sends_changes(const struct plant *plant, const struct plant_tag *tag);
/* Returns the default stale_s, for a tag that is not derived and whose row states none. */
double plant_tag_default_stale_s(const struct plant *plant, const struct plant_tag *tag);
/* Returns the Modbus unit (server address) of a tag that has a source: the tag's own, else the source's. */
int plant_tag_modbus_unit(const struct plant *plant, const struct plant_tag *tag);
/* Returns whether a tag's readings are simulated: its source, or for a derived tag the source of a tag in its expression, is simulated. */
bool plant_tag_simulated(const struct plant *plant, int tag);
/* Returns a folder of the systemd service plantcastd@NAME, whose plant file is /etc/plantcast/NAME/plant.yaml; NULL: `path` is
   not a service's plant file. name: `prepared` or `history`. Free with mem_free(). */
char *plant_service_folder(const char *path, const char *name);
/* Returns the folder of the prepared asset files: FOLDER/NAME.prepared next to NAME.yaml, or the service's folder. Free with
   mem_free(). */
char *plant_prepared_folder(const struct plant *plant);
/* Returns the folder where a command reads and writes recorded readings: plant_history_folder() if it has files, otherwise the
   systemd service's folder. A daemon started by hand leaves an empty folder if it recorded nothing. Free with mem_free(). */
char *plant_recorded_folder(const struct plant *plant);
/* Returns the folder where the daemon records readings: FOLDER/NAME.history, unless the plant file names another. Free with mem_free(). */
char *plant_history_folder(const struct plant *plant);

#endif
