/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Confines processes with Landlock and seccomp. Defines Landlock's constants itself and uses raw system calls, because the
   headers of Debian 12 know only ABI 2 of Landlock. */
#include "base/system/confine.h"

#include <errno.h>
#include <fcntl.h>
#include <linux/capability.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include "base/mem.h"

#ifndef SYS_landlock_create_ruleset
#define SYS_landlock_create_ruleset 444
#define SYS_landlock_add_rule 445
#define SYS_landlock_restrict_self 446
#endif

/* constants from linux/landlock.h */
enum { VERSION_QUERY = 1, RULE_PATH_BENEATH = 1 };
enum { ABI_RENAME = 2, ABI_TRUNCATE = 3, ABI_TCP = 4, ABI_DEVICES = 5, ABI_SCOPES = 6 };
enum {
    EXECUTE = 1 << 0,
    WRITE_FILE = 1 << 1,
    READ_FILE = 1 << 2,
    READ_FOLDER = 1 << 3,
    REMOVE_FOLDER = 1 << 4,
    REMOVE_FILE = 1 << 5,
    MAKE_FOLDER = 1 << 7,
    MAKE_FILE = 1 << 8,
    MAKE_SOCKET = 1 << 9,
    MAKE_FIFO = 1 << 10,
    MAKE_SYMLINK = 1 << 12,
    ALL_OF_ABI_1 = (1 << 13) - 1,
    RENAME = 1 << 13,
    TRUNCATE = 1 << 14,
    CONTROL_DEVICE = 1 << 15,
    OF_FILES = EXECUTE | WRITE_FILE | READ_FILE | TRUNCATE | CONTROL_DEVICE,
    BIND_AND_CONNECT_TCP = 3,
    ABSTRACT_SOCKETS_AND_SIGNALS = 3
};

struct path_rule {
    uint64_t allowed;
    int32_t parent;
} __attribute__((packed));

/* Paths that every program needs: libraries, fonts, the dynamic loader, and kernel files that the C library and V8 read. */
static const struct confine_path system_paths[] = {
    { "/lib", CONFINE_READ },
    { "/lib32", CONFINE_READ },
    { "/lib64", CONFINE_READ },
    { "/usr/lib", CONFINE_READ },
    { "/usr/lib64", CONFINE_READ },
    { "/usr/local/lib", CONFINE_READ },
    { "/usr/share", CONFINE_READ },
    { "/usr/local/share", CONFINE_READ },
    { "/etc/ld.so.cache", CONFINE_READ },
    { "/etc/localtime", CONFINE_READ },
    { "/etc/fonts", CONFINE_READ },
    { "/etc/ssl/openssl.cnf", CONFINE_READ },
    { "/dev/urandom", CONFINE_READ },
    { "/dev/zero", CONFINE_READ },
    { "/sys/devices/system", CONFINE_READ },
    { "/sys/fs/cgroup", CONFINE_READ },
    { "/sys/kernel/mm/transparent_hugepage", CONFINE_READ },
    { "/proc/meminfo", CONFINE_READ },
    { "/proc/cpuinfo", CONFINE_READ },
    { "/proc/stat", CONFINE_READ },
    { "/proc/version_signature", CONFINE_READ },
    { "/proc/sys/vm", CONFINE_READ },
    { "/lib64/ld-linux-x86-64.so.2", CONFINE_EXECUTE },
    { "/lib/ld-linux-aarch64.so.1", CONFINE_EXECUTE },
};

static int landlock_abi(void)
{
    return (int)syscall(SYS_landlock_create_ruleset, NULL, 0, VERSION_QUERY);
}

struct confine_ruleset confine_ruleset_of(int abi)
{
    if (abi < 1)
        return (struct confine_ruleset){ 0 };
    return (struct confine_ruleset){
        .files = ALL_OF_ABI_1 | (abi >= ABI_RENAME ? RENAME : 0) | (abi >= ABI_TRUNCATE ? TRUNCATE : 0) |
                 (abi >= ABI_DEVICES ? CONTROL_DEVICE : 0),
        .tcp = abi >= ABI_TCP ? BIND_AND_CONNECT_TCP : 0,
        .scoped = abi >= ABI_SCOPES ? ABSTRACT_SOCKETS_AND_SIGNALS : 0,
    };
}

static uint64_t rights_of(enum confine_access access, enum confine_role role)
{
    uint64_t rights = READ_FILE | READ_FOLDER;
    if (access == CONFINE_EXECUTE)
        rights |= EXECUTE;
    if (access == CONFINE_WRITE)
        rights |= WRITE_FILE | REMOVE_FOLDER | REMOVE_FILE | MAKE_FOLDER | MAKE_FILE | RENAME | TRUNCATE;
    if (access == CONFINE_WRITE && role == CONFINE_COMMAND)
        rights |= MAKE_SOCKET | MAKE_FIFO | MAKE_SYMLINK | EXECUTE;
    return rights;
}

/* Adds a path to the ruleset. Skips a path that does not exist or that this user cannot reach, without an error. */
static int permit(int ruleset, const char *path, uint64_t rights)
{
    struct stat st;
    int file = open(path, O_PATH | O_CLOEXEC), status = 0;
    if (file < 0)
        return 0;
    if (fstat(file, &st) == 0 && !S_ISDIR(st.st_mode))
        rights &= OF_FILES;
    struct path_rule rule = { .allowed = rights, .parent = file };
    if (syscall(SYS_landlock_add_rule, ruleset, RULE_PATH_BENEATH, &rule, 0) != 0)
        status = -errno;
    close(file);
    return status;
}

/* Allows reading ThreadSanitizer's list of suppressions, which it needs when a program starts. No-op in other builds. */
static int permit_suppressions(int ruleset)
{
    int status = 0;
#ifdef __SANITIZE_THREAD__
    const char *options = getenv("TSAN_OPTIONS"), *list = options ? strstr(options, "suppressions=") : NULL;
    char path[4096];
    if (list && sscanf(list, "suppressions=%4095[^:]", path) == 1)
        status = permit(ruleset, path, READ_FILE);
#endif
    (void)ruleset;
    return status;
}

static int restrict_paths(const struct confine_params *params, int abi)
{
    const struct confine_ruleset attributes = confine_ruleset_of(abi);
    uint64_t known = attributes.files;
    /* passes a structure with all members: an older kernel, whose structure is smaller, accepts it if the excess bytes are zero */
    int ruleset = (int)syscall(SYS_landlock_create_ruleset, &attributes, sizeof(attributes), 0);
    int status = ruleset < 0 ? -errno : permit(ruleset, "/dev/null", (READ_FILE | WRITE_FILE | TRUNCATE) & known);
    for (size_t i = 0; i < sizeof(system_paths) / sizeof(system_paths[0]) && status == 0; i++)
        status = permit(ruleset, system_paths[i].path, rights_of(system_paths[i].access, params->role) & known);
    /* lets a command read all of /proc, because the names of its child processes there are unknown in advance; a program that
       reads models may read only its own entry */
    if (status == 0)
        status = permit(ruleset, params->role == CONFINE_READER ? "/proc/self" : "/proc", READ_FILE | READ_FOLDER);
    if (status == 0)
        status = permit_suppressions(ruleset);
    for (size_t i = 0; i < params->path_count && status == 0; i++)
        status = permit(ruleset, params->paths[i].path, rights_of(params->paths[i].access, params->role) & known);
    if (status == 0 && syscall(SYS_landlock_restrict_self, ruleset, 0) != 0)
        status = -errno;
    if (ruleset >= 0)
        close(ruleset);
    return status;
}

/* Drops all capabilities, except root's access to other users' folders and, in a command, the right to change a file's owner. */
static void drop_capabilities(enum confine_role role)
{
    uint32_t kept = 1U << CAP_DAC_OVERRIDE | 1U << CAP_DAC_READ_SEARCH;
    struct __user_cap_header_struct header = { .version = _LINUX_CAPABILITY_VERSION_3 };
    struct __user_cap_data_struct data[_LINUX_CAPABILITY_U32S_3];
    if (role != CONFINE_READER)
        kept |= 1U << CAP_CHOWN | 1U << CAP_FOWNER;
    if (syscall(SYS_capget, &header, data) != 0)
        return;
    data[0].effective = data[0].permitted &= kept;
    data[1].effective = data[1].permitted = data[0].inheritable = data[1].inheritable = 0;
    syscall(SYS_capset, &header, data);
    prctl(PR_CAP_AMBIENT, PR_CAP_AMBIENT_CLEAR_ALL, 0, 0, 0);
}

static void offer_to_oom_killer(void)
{
    int file = open("/proc/self/oom_score_adj", O_WRONLY | O_CLOEXEC);
    if (file >= 0) {
        ssize_t written = write(file, "1000", 4);
        (void)written; /* ignores the result: if the kernel refuses the write, the OOM score keeps its default */
        close(file);
    }
}

int confine(const struct confine_params *params)
{
    int abi = landlock_abi();
    if (params->most_abi && abi > params->most_abi)
        abi = params->most_abi;
    offer_to_oom_killer();
    drop_capabilities(params->role);
    if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0)
        return -errno;
    /* Commands also move files between folders. Landlock before its version ABI_RENAME always forbids that in a restricted
       process. With such a kernel, the paths of commands are therefore not restricted. */
    bool moves_files = params->role != CONFINE_READER;
    int status = abi < 1 || (abi < ABI_RENAME && moves_files) ? 0 : restrict_paths(params, abi);
    if (status != 0)
        return status;
    status = confine_calls(params->role, params->notifies);
    /* returns 0 if the kernel has no seccomp filters: confine_lacks() reports that */
    return status == -ENOSYS || status == -EINVAL ? 0 : status;
}

bool confine_lacks_with(int abi, bool calls, char out[CONFINE_LACKS_BYTES])
{
    static const struct {
        int abi;
        const char *missing;
    } parts[] = {
        /* Actions that an older kernel lets confined commands do. abi: first Landlock version that can forbid it; missing: text
           for the warning. The table is about commands that the plant file lists under `convert`. Programs that read models can
           do none of this, because seccomp blocks the system calls. TCP and devices are not in the table, because seccomp
           blocks them for commands, too. */
        { ABI_RENAME, "read and write all files of this user" },
        { ABI_TRUNCATE, "truncate all files that this user may write" },
        { ABI_SCOPES, "signal other processes of this user" },
    };
    size_t used = 0;
    out[0] = 0;
    if (abi < 1)
        used = (size_t)snprintf(out, CONFINE_LACKS_BYTES,
                                "no Landlock: programs that read uploaded files can read and write all files of this user");
    else if (abi < ABI_SCOPES)
        used = (size_t)snprintf(out, CONFINE_LACKS_BYTES, "only ABI %d of Landlock: commands under `convert` can ", abi);
    for (size_t i = 0, said = 0; i < sizeof(parts) / sizeof(parts[0]) && abi >= 1; i++)
        if (abi < parts[i].abi)
            used += (size_t)snprintf(out + used, CONFINE_LACKS_BYTES - used, "%s%s", said++ ? ", " : "", parts[i].missing);
    if (abi < ABI_SCOPES)
        used += (size_t)snprintf(out + used, CONFINE_LACKS_BYTES - used, " (needs Linux 6.12 with landlock in its list of LSMs)");
    if (!calls)
        snprintf(out + used, CONFINE_LACKS_BYTES - used,
                 "%sno seccomp: programs that read uploaded files can make any system call (needs CONFIG_SECCOMP_FILTER)",
                 used ? "; " : "");
    return *out != 0;
}

bool confine_lacks(char out[CONFINE_LACKS_BYTES])
{
    return confine_lacks_with(landlock_abi(), prctl(PR_GET_SECCOMP, 0, 0, 0, 0) >= 0, out);
}

void confine_hide_memory(void)
{
    setrlimit(RLIMIT_CORE, &(struct rlimit){ 0, 0 });
    prctl(PR_SET_DUMPABLE, 0, 0, 0, 0);
}

#ifdef __SANITIZE_ADDRESS__
/* LeakSanitizer calls this function before it looks for leaks, and skips the search if it returns true. It would inspect the
   process with ptrace(), which confined processes and those with hidden memory deny. */
int __lsan_is_turned_off(void);
int __lsan_is_turned_off(void)
{
    return prctl(PR_GET_SECCOMP, 0, 0, 0, 0) != 0 || prctl(PR_GET_DUMPABLE, 0, 0, 0, 0) != 1;
}
#endif

static bool is_kept(const char *entry, bool notifies, bool own_home)
{
    static const char *const names[] = { "PATH=",  "LANG=",         "LANGUAGE=",     "LC_",           "TZ=",
                                         "TZDIR=", "ASAN_OPTIONS=", "LSAN_OPTIONS=", "TSAN_OPTIONS=", "UBSAN_OPTIONS=" };
    for (size_t i = 0; i < sizeof(names) / sizeof(names[0]); i++)
        if (!strncmp(entry, names[i], strlen(names[i])))
            return true;
    if (own_home && (!strncmp(entry, "HOME=", 5) || !strncmp(entry, "TMPDIR=", 7)))
        return true;
    return notifies && !strncmp(entry, "NOTIFY_SOCKET=", 14);
}

char **confine_environment(const char *home, bool notifies)
{
    size_t count = 0, bytes = home ? 2 * strlen(home) + 16 : 0;
    for (char **entry = environ; entry && *entry; entry++)
        if (is_kept(*entry, notifies, !home)) {
            count++;
            bytes += strlen(*entry) + 1;
        }
    char **kept = mem_new((count + 3) * sizeof(*kept) + bytes), *text = (char *)(kept + count + 3);
    count = 0;
    for (char **entry = environ; entry && *entry; entry++)
        if (is_kept(*entry, notifies, !home)) {
            kept[count++] = text;
            text = stpcpy(text, *entry) + 1;
        }
    if (home) {
        kept[count++] = text;
        text = stpcpy(stpcpy(text, "HOME="), home) + 1;
        kept[count++] = text;
        stpcpy(stpcpy(text, "TMPDIR="), home);
    }
    return kept;
}
