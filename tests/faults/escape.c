/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A reader that an attacker has taken over: replaces plantcast-import-assimp and tries to reach the daemon and the machine.
   Prints a line for each attempt, "NAME succeeded" or "NAME refused ERROR". Its input names the targets in a line "PID PORT
   SECRET STATE-FILE". Built as escape.so, it is preloaded into a program that confines itself, and the attempts run in that
   program's first fopen() under confinement. PLANTCAST_TARGETS then holds that line, and PLANTCAST_OWN names a folder that the
   program may write (default: the current one). The file `escaped` in it receives the output, or stdout if that file cannot be
   made. With the input "hang" it waits forever. usage: escape INPUT OUTPUT ... */
#include <arpa/inet.h>
#include <dlfcn.h>
#include <errno.h>
#include <fcntl.h>
#include <linux/bpf.h>
#include <linux/capability.h>
#include <linux/io_uring.h>
#include <linux/perf_event.h>
#include <sched.h>
#include <setjmp.h>
#include <signal.h>
#include <stdatomic.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/ioctl.h>
#include <sys/ipc.h>
#include <sys/mman.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/ptrace.h>
#include <sys/resource.h>
#include <sys/shm.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/uio.h>
#include <sys/wait.h>
#include <unistd.h>

static int pid, port, kept_stdout = -1;
static char secret[512], state[512], folder[512], path[1200];
static int tried, got_through;

static void result(const char *name, bool succeeded)
{
    int cause = errno;
    tried++;
    got_through += succeeded;
    printf("%s %s %s\n", name, succeeded ? "succeeded" : "refused", succeeded ? "" : strerrorname_np(cause));
    fflush(stdout);
}

/* --- files ------------------------------------------------------------------------------------------------------------ */

static bool opens(const char *file, int flags)
{
    char byte;
    int fd = open(file, flags | O_CLOEXEC, 0600);
    bool good = fd >= 0 && ((flags & O_ACCMODE) != O_RDONLY || (flags & O_DIRECTORY) || read(fd, &byte, 1) >= 0);
    if (fd >= 0)
        close(fd);
    return good;
}

/* Returns whether the process can truncate a file that it opens only for reading (O_RDONLY | O_TRUNC). Tries it on a file of
   its own, so that no data is lost. */
static bool empties(void)
{
    int fd = open("emptied", O_WRONLY | O_CREAT | O_CLOEXEC, 0600);
    bool written = fd >= 0 && write(fd, "x", 1) == 1;
    if (fd >= 0)
        close(fd);
    bool good = written && opens("emptied", O_RDONLY | O_TRUNC);
    int cause = errno;
    unlink("emptied");
    errno = cause;
    return good;
}

static const char *beside_state(const char *name)
{
    snprintf(path, sizeof(path), "%s/%s", folder, name);
    return path;
}

static const char *of_daemon(const char *name)
{
    snprintf(path, sizeof(path), "/proc/%d/%s", pid, name);
    return path;
}

static bool makes(const char *file)
{
    bool good = opens(file, O_WRONLY | O_CREAT | O_EXCL);
    if (good)
        unlink(file);
    return good;
}

static void try_files(void)
{
    struct stat st;
    struct { struct file_handle handle; char room[128]; } handle = { .handle.handle_bytes = 128 };
    int mount_id;
    result("read-secret", opens(secret, O_RDONLY));
    result("list-folder-of-secret", opens(folder, O_RDONLY | O_DIRECTORY));
    result("read-etc-passwd", opens("/etc/passwd", O_RDONLY));
    result("list-root", opens("/", O_RDONLY | O_DIRECTORY));
    result("empty-by-reading", empties());
    result("append-to-state", opens(state, O_WRONLY | O_APPEND));
    result("truncate-state", stat(state, &st) == 0 && truncate(state, st.st_size) == 0);
    result("chmod-state", stat(state, &st) == 0 && chmod(state, st.st_mode & 07777) == 0);
    result("chown-state", stat(state, &st) == 0 && chown(state, st.st_uid, st.st_gid) == 0);
    result("touch-state", utimensat(AT_FDCWD, state, NULL, 0) == 0);
    result("create-in-state-folder", makes(beside_state("made")));
    result("mkdir-in-state-folder", mkdir(beside_state("made.d"), 0700) == 0);
    rmdir(beside_state("made.d"));
    result("rename-state", rename(state, beside_state("gone")) == 0);
    rename(beside_state("gone"), state);
    result("symlink-in-state-folder", symlink(secret, beside_state("link")) == 0);
    unlink(beside_state("link"));
    result("symlink-in-own-folder", symlink(secret, "link") == 0);
    unlink("link");
    result("hard-link-in-own-folder", link(secret, "hard") == 0);
    unlink("hard");
    result("fifo-in-own-folder", mkfifo("fifo", 0600) == 0);
    unlink("fifo");
    result("create-in-tmp", makes("/tmp/plantcast-escape"));
    result("create-in-dev-shm", makes("/dev/shm/plantcast-escape"));
    result("name-to-handle", name_to_handle_at(AT_FDCWD, "/", &handle.handle, &mount_id, 0) == 0);
    result("set-attribute", syscall(SYS_setxattr, secret, "user.plantcast", "1", 1, 0) == 0);
}

/* --- the daemon's process ------------------------------------------------------------------------------------------------- */

static bool takes_a_descriptor(void)
{
    int process = (int)syscall(SYS_pidfd_open, pid, 0), taken = -1;
    for (int fd = 0; fd < 64 && process >= 0 && taken < 0; fd++)
        taken = (int)syscall(SYS_pidfd_getfd, process, fd, 0);
    return taken >= 0;
}

static bool reads_memory(void)
{
    char bytes[16];
    struct iovec here = { bytes, sizeof(bytes) }, there = { (void *)&pid, sizeof(bytes) };
    return process_vm_readv(pid, &here, 1, &there, 1, 0) >= 0 || errno == EFAULT; /* EFAULT: permitted, not mapped there */
}

static void try_process(void)
{
    cpu_set_t cpus;
    siginfo_t info = { .si_code = SI_QUEUE, .si_signo = SIGURG };
    struct rlimit limits;
    int pipes[2], process = (int)syscall(SYS_pidfd_open, pid, 0);
    result("open-memory", opens(of_daemon("mem"), O_RDWR));
    result("read-environment", opens(of_daemon("environ"), O_RDONLY));
    result("read-maps", opens(of_daemon("maps"), O_RDONLY));
    result("list-descriptors", opens(of_daemon("fd"), O_RDONLY | O_DIRECTORY));
    result("read-memory", reads_memory());
    bool attached = ptrace(PTRACE_SEIZE, pid, NULL, NULL) == 0;
    result("ptrace", attached);
    if (attached)
        ptrace(PTRACE_DETACH, pid, NULL, NULL);
    result("take-descriptor", takes_a_descriptor());
    /* the default action for SIGURG is to ignore it, so the attempt does no harm if it succeeds */
    result("kill", kill(pid, SIGURG) == 0);
    result("kill-probe", kill(pid, 0) == 0);
    result("tgkill", syscall(SYS_tgkill, pid, pid, SIGURG) == 0);
    result("tkill", syscall(SYS_tkill, pid, SIGURG) == 0);
    result("queue-signal", syscall(SYS_rt_sigqueueinfo, pid, SIGURG, &info) == 0);
    result("signal-by-pidfd", syscall(SYS_pidfd_send_signal, process, SIGURG, NULL, 0) == 0);
    result("signal-by-owner", pipe(pipes) == 0 && fcntl(pipes[0], F_SETOWN, pid) == 0);
    result("kill-parent", kill(getppid(), 0) == 0);
    result("limit-daemon", getrlimit(RLIMIT_CORE, &limits) == 0 && prlimit(pid, RLIMIT_CORE, &limits, NULL) == 0);
    result("pin-daemon", sched_getaffinity(0, sizeof(cpus), &cpus) == 0 && sched_setaffinity(pid, sizeof(cpus), &cpus) == 0);
    result("renice-daemon", setpriority(PRIO_PROCESS, (id_t)pid, 0) == 0);
    result("ionice-daemon", syscall(SYS_ioprio_set, 1, pid, 0) == 0);
    result("advise-daemon", syscall(SYS_process_madvise, process, &(struct iovec){ (void *)4096, 4096 }, 1, MADV_COLD, 0) >= 0);
    result("compare-files", syscall(SYS_kcmp, pid, getpid(), 2 /* KCMP_FILES: compares the tables of open files */, 0, 0) >= 0);
}

/* --- the network ------------------------------------------------------------------------------------------------------------ */

static bool has_socket(int family, int type)
{
    int fd = socket(family, type | SOCK_CLOEXEC, 0);
    if (fd >= 0)
        close(fd);
    return fd >= 0;
}

static bool connects(void)
{
    struct sockaddr_in to = { .sin_family = AF_INET, .sin_port = htons((uint16_t)port), .sin_addr.s_addr = htonl(INADDR_LOOPBACK) };
    int fd = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    bool good = fd >= 0 && connect(fd, (struct sockaddr *)&to, sizeof(to)) == 0;
    if (fd >= 0)
        close(fd);
    return good;
}

static void try_network(void)
{
    result("connect-to-daemon", connects());
    result("socket-inet", has_socket(AF_INET, SOCK_STREAM));
    result("socket-inet6-udp", has_socket(AF_INET6, SOCK_DGRAM));
    result("socket-unix", has_socket(AF_UNIX, SOCK_STREAM));
    result("socket-netlink", has_socket(AF_NETLINK, SOCK_RAW));
    result("socket-packet", has_socket(AF_PACKET, SOCK_RAW));
    result("socket-alg", has_socket(AF_ALG, SOCK_SEQPACKET));
    result("socket-vsock", has_socket(AF_VSOCK, SOCK_STREAM));
}

/* --- the kernel -------------------------------------------------------------------------------------------------------------- */

/* Runs an attempt in a forked child, because it changes the state of its process. If fork fails, the attempt runs in this
   process. */
static void in_copy(const char *name, bool (*attempt)(void))
{
    int status = 0;
    pid_t copy = fork();
    if (copy <= 0) {
        bool good = attempt();
        if (copy == 0)
            _exit(good ? 0 : errno ? errno : 1);
        result(name, good);
        return;
    }
    waitpid(copy, &status, 0);
    errno = WIFEXITED(status) ? WEXITSTATUS(status) : EINTR;
    result(name, status == 0);
}

static bool new_user_namespace(void)
{
    return unshare(CLONE_NEWUSER) == 0;
}

static bool new_mount_namespace(void)
{
    return unshare(CLONE_NEWNS) == 0;
}

static bool mounts(void)
{
    return unshare(CLONE_NEWNS) == 0 && mount(NULL, "/", NULL, MS_REC | MS_PRIVATE, NULL) == 0 &&
           mount("none", "/mnt", "tmpfs", 0, NULL) == 0;
}

static bool changes_root(void)
{
    return chroot("/usr") == 0;
}

static bool changes_user(void)
{
    return setresuid(65534, 65534, 65534) == 0;
}

static bool regains_capabilities(void)
{
    struct __user_cap_header_struct header = { .version = _LINUX_CAPABILITY_VERSION_3 };
    struct __user_cap_data_struct data[2];
    if (syscall(SYS_capget, &header, data) != 0)
        return false;
    data[0].permitted = data[0].effective |= 1U << CAP_SYS_PTRACE;
    return syscall(SYS_capset, &header, data) == 0;
}

static sigjmp_buf back;

static void on_fault(int number)
{
    (void)number;
    siglongjmp(back, 1);
}

static bool calls_as_32_bit(void)
{
#ifdef __x86_64__
    long answer = 20; /* 20 is the number of the system call getpid for 32-bit programs */
    signal(SIGSEGV, on_fault);
    if (sigsetjmp(back, 1) != 0)
        errno = ENOSYS;
    else
        __asm__ volatile("int $0x80" : "+a"(answer) : : "memory", "r8", "r9", "r10", "r11");
    signal(SIGSEGV, SIG_DFL);
    if (answer == 20 || answer < 0) {
        errno = ENOSYS;
        return false;
    }
    return true;
#else
    errno = ENOSYS;
    return false;
#endif
}

static void try_kernel(void)
{
    struct io_uring_params ring = { 0 };
    union bpf_attr bpf = { .map_type = BPF_MAP_TYPE_ARRAY, .key_size = 4, .value_size = 4, .max_entries = 1 };
    struct perf_event_attr perf = { .type = PERF_TYPE_SOFTWARE, .size = sizeof(perf), .config = PERF_COUNT_SW_CPU_CLOCK };
    long flags[11] = { CLONE_NEWUSER };
    int terminal = open("/dev/ptmx", O_RDWR | O_NOCTTY | O_CLOEXEC);
    result("io_uring", syscall(SYS_io_uring_setup, 1, &ring) >= 0);
    result("bpf", syscall(SYS_bpf, BPF_MAP_CREATE, &bpf, sizeof(bpf)) >= 0);
    result("keyctl", syscall(SYS_keyctl, 0 /* get the session's keyring */, -3, 0) >= 0);
    result("add-key", syscall(SYS_add_key, "user", "plantcast", "x", 1, -2 /* keyring of the process */) >= 0);
    result("userfaultfd", syscall(SYS_userfaultfd, 1) >= 0);
    result("perf", syscall(SYS_perf_event_open, &perf, 0, -1, -1, 0) >= 0);
    in_copy("user-namespace", new_user_namespace);
    in_copy("mount-namespace", new_mount_namespace);
    in_copy("mount", mounts);
    in_copy("chroot", changes_root);
    in_copy("other-user", changes_user);
    in_copy("regain-ptrace", regains_capabilities);
    /* the dynamic loader (ld.so) may run, and it can map any program that may be read */
    result("program-for-the-loader", opens("/bin/true", O_RDONLY));
    in_copy("call-as-32-bit", calls_as_32_bit);
    pid_t copy = fork();
    if (copy == 0)
        _exit(0);
    result("fork", copy > 0);
    copy = (pid_t)syscall(SYS_clone3, flags, sizeof(flags));
    if (copy == 0)
        _exit(0);
    result("clone3-namespace", copy > 0);
    result("memfd", syscall(SYS_memfd_create, "x", 0) >= 0);
    result("shared-memory", shmget(IPC_PRIVATE, 4096, IPC_CREAT | 0600) >= 0);
    result("message-queue", syscall(SYS_msgget, IPC_PRIVATE, IPC_CREAT | 0600) >= 0);
    result("fanotify", syscall(SYS_fanotify_init, 0, 0) >= 0);
    result("open-terminal", terminal >= 0);
    result("type-into-terminal", terminal >= 0 ? ioctl(terminal, TIOCSTI, "x") == 0 : ioctl(STDOUT_FILENO, TIOCSTI, "x") == 0);
    result("kernel-log", syscall(SYS_syslog, 10 /* get the size of the kernel's log */, NULL, 0) >= 0);
    result("undo-hiding", prctl(PR_SET_DUMPABLE, 1) == 0);
}

/* Returns whether the descriptor was inherited by mistake. A memfd is inherited on purpose: plantcast-match and similar
   programs write their results to it. */
static bool is_inherited(int fd)
{
    char link[32], target[64];
    snprintf(link, sizeof(link), "/proc/self/fd/%d", fd);
    ssize_t length = readlink(link, target, sizeof(target) - 1);
    target[length > 0 ? length : 0] = 0;
    bool inherited = fd != kept_stdout && fcntl(fd, F_GETFD) >= 0 && strncmp(target, "/memfd:", 7) != 0;
    if (inherited)
        printf("descriptor %d: %s\n", fd, target);
    return inherited;
}

static void try_inheritance(void)
{
    int open_ones = 0;
    for (int fd = 3; fd < 256; fd++)
        open_ones += is_inherited(fd);
    errno = EBADF;
    result("inherited-descriptor", open_ones > 0);
    errno = ENOENT;
    result("inherited-secret", getenv("PLANTCAST_ESCAPE") != NULL);
}

/* Writes a valid model, so that the importer succeeds and shows the printed lines. */
static bool write_triangle(const char *glb)
{
    static const char json[] = "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,"
                               "\"scenes\":[{\"nodes\":[0]}],\"nodes\":[{\"mesh\":0,\"name\":\"N\"}],"
                               "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0}}]}],\"accessors\":[{\"bufferView\":0,"
                               "\"componentType\":5126,\"count\":3,\"type\":\"VEC3\",\"min\":[0,0,0],\"max\":[1,1,0]}],\"bufferViews\":"
                               "[{\"buffer\":0,\"byteLength\":36}],\"buffers\":[{\"byteLength\":36}]}   ";
    static const float corners[9] = { 0, 0, 0, 1, 0, 0, 0, 1, 0 };
    const uint32_t length = (sizeof(json) - 1) / 4 * 4, head[5] = { 0x46546c67, 2, 28 + length + 36, length, 0x4e4f534a };
    const uint32_t binary[2] = { 36, 0x004e4942 };
    FILE *file = fopen(glb, "wb");
    bool good = file && fwrite(head, sizeof(head), 1, file) == 1 && fwrite(json, length, 1, file) == 1 &&
                fwrite(binary, sizeof(binary), 1, file) == 1 && fwrite(corners, sizeof(corners), 1, file) == 1;
    return file && fclose(file) == 0 && good;
}

static bool take_targets(const char *line)
{
    if (!line || sscanf(line, "%d %d %511s %511s", &pid, &port, secret, state) != 4)
        return false;
    snprintf(folder, sizeof(folder), "%s", state);
    *strrchr(folder, '/') = 0;
    return true;
}

static void try_all(void)
{
    try_inheritance();
    try_files();
    try_process();
    try_network();
    try_kernel();
    printf("%d attempts, %d succeeded\n", tried, got_through);
    fflush(stdout);
}

#ifdef __PIC__
static bool preloaded;
static atomic_bool begun;

/* Reads the targets when the library is loaded, because child processes get a filtered environment. */
__attribute__((constructor)) static void begin(void)
{
    preloaded = take_targets(getenv("PLANTCAST_TARGETS"));
}

/* Returns whether the program is already confined: the system call filter of the file readers refuses this harmless call. */
static bool is_confined(void)
{
    return prctl(PR_GET_SECCOMP, 0, 0, 0, 0) < 0 && errno == EPERM;
}

FILE *fopen(const char *file, const char *mode)
{
    FILE *(*next)(const char *, const char *) = NULL;
    *(void **)&next = dlsym(RTLD_NEXT, "fopen");
    if (preloaded && is_confined() && !atomic_exchange(&begun, true)) {
        const char *own = getenv("PLANTCAST_OWN");
        if (own && chdir(own) != 0)
            return NULL;
        int out = open("escaped", O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
        if (out >= 0) {
            kept_stdout = dup(STDOUT_FILENO);
            dup2(out, STDOUT_FILENO);
            close(out);
        }
        try_all();
        if (kept_stdout >= 0) {
            dup2(kept_stdout, STDOUT_FILENO);
            close(kept_stdout);
        }
    }
    return next(file, mode);
}
#endif

int main(int argc, char **argv)
{
    char line[1100] = "";
    FILE *input = argc > 1 ? fopen(argv[1], "r") : NULL;
    if (!input || !fgets(line, sizeof(line), input))
        return 2;
    while (!strcmp(line, "hang\n"))
        pause();
    if (!take_targets(line))
        return 2;
    fclose(input);
    try_all();
    if (argc > 2 && !write_triangle(argv[2]))
        return 3;
    execl("/bin/sh", "sh", "-c", "echo shell succeeded", NULL); /* the last attempt, because it replaces this program */
    result("shell", false);
    return 0;
}
