/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Reads and writes the file FOLDER/node, which contains the core's random number, the file's inode number, and the machine's id. */
#include "corelink/node_id.h"

#include <errno.h>
#include <fcntl.h>
#include <stdio.h>
#include <stdint.h>
#include <string.h>
#include <sys/file.h>
#include <sys/random.h>
#include <sys/stat.h>
#include <unistd.h>

#include "base/mem.h"
#include "base/text/text.h"

enum { LINE_BYTES = 128, MACHINE_BYTES = 64 };

static void read_machine(char out[MACHINE_BYTES])
{
    size_t count;
    char *text = text_read_file("/etc/machine-id", MACHINE_BYTES - 1, &count);
    size_t length = text ? strcspn(text, " \t\r\n") : 0;
    snprintf(out, MACHINE_BYTES, "%.*s", length ? (int)length : 1, length ? text : "-");
    mem_free(text);
}

/* Reads the core's random number from the file. Returns false if the folder is a copy: the inode or the machine's id then
   differs from the one in the file. */
static bool read_id(struct node_id *id, unsigned long long inode, const char *machine)
{
    char line[LINE_BYTES] = "", of[MACHINE_BYTES] = "";
    unsigned long long told;
    return pread(id->fd, line, sizeof(line) - 1, 0) > 0 && sscanf(line, "%8[0-9a-f] %llu %63s", id->id, &told, of) == 3 &&
           strlen(id->id) == 8 && told == inode && !strcmp(of, machine);
}

static bool write_id(struct node_id *id, unsigned long long inode, const char *machine)
{
    char line[LINE_BYTES];
    uint32_t number;
    if (getrandom(&number, sizeof(number), 0) != sizeof(number))
        return false;
    snprintf(id->id, sizeof(id->id), "%08x", number);
    int count = snprintf(line, sizeof(line), "%s %llu %s\n", id->id, inode, machine);
    return ftruncate(id->fd, 0) == 0 && pwrite(id->fd, line, (size_t)count, 0) == count && fsync(id->fd) == 0;
}

char *node_id_take(struct node_id *id, const char *folder)
{
    char *path = mem_printf("%s/node", folder), *why = NULL, machine[MACHINE_BYTES];
    struct stat st;
    mkdir(folder, 0777);
    read_machine(machine);
    *id = (struct node_id){ .fd = open(path, O_RDWR | O_CREAT | O_CLOEXEC, 0600) };
    if (id->fd >= 0 && flock(id->fd, LOCK_EX | LOCK_NB) != 0)
        why = errno == EWOULDBLOCK
                  ? mem_printf("%s: another core on this machine uses this history folder: give each core its own folder with --history",
                               folder)
                  : mem_printf("%s: cannot be locked: %s", path, strerror(errno));
    else if (id->fd < 0 || fstat(id->fd, &st) != 0 || (!read_id(id, st.st_ino, machine) && !write_id(id, st.st_ino, machine)))
        why = mem_printf("%s: %s", path, strerror(errno));
    if (why)
        node_id_release(id);
    mem_free(path);
    return why;
}

void node_id_release(struct node_id *id)
{
    if (id->fd > 0)
        close(id->fd);
    id->fd = 0;
}
