#include "engine/workers/worker_pool.hpp"

#include "engine/workers/worker_wire.hpp"
#include "gl/context.hpp"
#include "hemi/core/error.hpp"
#include "hemi/core/interrupt.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <csignal>
#include <cstring>
#include <thread>
#include <utility>
#include <vector>

#include <fcntl.h>
#include <poll.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

extern char** environ;

namespace hemi {

namespace {

class Descriptor {
public:
    Descriptor() = default;
    explicit Descriptor(int fd) : fd_(fd) {}
    Descriptor(Descriptor&& other) noexcept : fd_(std::exchange(other.fd_, -1)) {}
    Descriptor& operator=(Descriptor&& other) noexcept {
        std::swap(fd_, other.fd_);
        return *this;
    }
    ~Descriptor() {
        if (fd_ >= 0) {
            close(fd_);
        }
    }
    [[nodiscard]] int get() const noexcept { return fd_; }

private:
    int fd_ = -1;
};

[[noreturn]] void fail(const char* what) {
    throw Error(fmt::format("worker processes: {}: {}", what, std::strerror(errno)));
}

/// Anonymous shared memory, seen by this process and by the worker that inherits the descriptor.
class SharedMemory {
public:
    SharedMemory(const char* name, std::size_t bytes) : fd_(memfd_create(name, MFD_CLOEXEC)), bytes_(bytes) {
        if (fd_.get() < 0 || ftruncate(fd_.get(), static_cast<off_t>(bytes)) != 0) {
            fail("shared memory");
        }
        void* memory = mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, fd_.get(), 0);
        if (memory == MAP_FAILED) {
            fail("shared memory");
        }
        memory_ = static_cast<std::byte*>(memory);
    }
    SharedMemory(SharedMemory&& other) noexcept
        : fd_(std::move(other.fd_)), memory_(std::exchange(other.memory_, nullptr)), bytes_(other.bytes_) {}
    SharedMemory& operator=(SharedMemory&&) = delete;
    ~SharedMemory() {
        if (memory_ != nullptr) {
            munmap(memory_, bytes_);
        }
    }
    [[nodiscard]] std::byte* data() const noexcept { return memory_; }
    [[nodiscard]] int fd() const noexcept { return fd_.get(); }

private:
    Descriptor fd_;
    std::byte* memory_ = nullptr;
    std::size_t bytes_;
};

/// One worker process; killed and reaped when it goes out of scope.
class WorkerProcess {
public:
    std::uint32_t jobs = 0; ///< sent and not finished

    WorkerProcess(const std::string& program, const SharedMemory& geometry, std::size_t result_bytes)
        : results_("hemi rows", result_bytes) {
        std::array<int, 2> ends{};
        if (socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) {
            fail("socket");
        }
        socket_ = Descriptor(ends[0]);
        const Descriptor far_end(ends[1]);
        // Out of the way of the numbers that the worker expects, so that none is overwritten by another.
        const Descriptor socket_copy = high_copy(far_end.get());
        const Descriptor geometry_copy = high_copy(geometry.fd());
        const Descriptor results_copy = high_copy(results_.fd());

        posix_spawn_file_actions_t actions;
        posix_spawn_file_actions_init(&actions);
        posix_spawn_file_actions_adddup2(&actions, socket_copy.get(), worker_socket_fd);
        posix_spawn_file_actions_adddup2(&actions, geometry_copy.get(), worker_geometry_fd);
        posix_spawn_file_actions_adddup2(&actions, results_copy.get(), worker_results_fd);
        std::string program_name = program;
        std::array<char*, 2> arguments{program_name.data(), nullptr};
        const int error = posix_spawn(&pid_, program.c_str(), &actions, nullptr, arguments.data(), environ);
        posix_spawn_file_actions_destroy(&actions);
        if (error != 0) {
            pid_ = -1;
            throw Error(
                fmt::format("worker processes: {} cannot be started: {}", program, std::strerror(error)));
        }
    }

    WorkerProcess(WorkerProcess&& other) noexcept
        : jobs(other.jobs), pid_(std::exchange(other.pid_, -1)), socket_(std::move(other.socket_)),
          results_(std::move(other.results_)) {}
    WorkerProcess& operator=(WorkerProcess&&) = delete;
    ~WorkerProcess() {
        if (pid_ > 0) {
            kill(pid_, SIGKILL);
            reap(nullptr);
        }
    }

    [[nodiscard]] int fd() const noexcept { return socket_.get(); }
    [[nodiscard]] std::byte* results() const noexcept { return results_.data(); }

    void send(const ToWorker& message) {
        if (::send(socket_.get(), &message, sizeof message, MSG_NOSIGNAL) != sizeof message) {
            ended();
        }
    }

    /// Waits for a message. @throws Error when the worker is gone, failed or is of another build.
    FromWorker receive() {
        std::array<char, sizeof(FromWorker)> packet{};
        ssize_t got = -1;
        do {
            got = recv(socket_.get(), packet.data(), packet.size(), 0);
        } while (got < 0 && errno == EINTR);
        if (got > 0) {
            if (const auto reason = refusal_reason({packet.data(), static_cast<std::size_t>(got)})) {
                throw Error(*reason);
            }
        }
        if (got != static_cast<ssize_t>(packet.size())) {
            ended();
        }
        FromWorker message;
        std::memcpy(&message, packet.data(), packet.size());
        if (message.kind == FromWorker::Kind::failed) {
            const std::string text(message.text.data());
            if (message.no_device != 0) {
                throw NoDevice(text);
            }
            throw GlError(text);
        }
        return message;
    }

private:
    static Descriptor high_copy(int fd) {
        const int copy = fcntl(fd, F_DUPFD_CLOEXEC, worker_results_fd + 1);
        if (copy < 0) {
            fail("descriptor");
        }
        return Descriptor(copy);
    }

    bool reap(int* status) const {
        pid_t got = -1;
        do {
            got = waitpid(pid_, status, 0);
        } while (got < 0 && errno == EINTR);
        return got == pid_;
    }

    [[noreturn]] void ended() {
        int status = 0;
        const bool reaped = reap(&status);
        pid_ = -1;
        if (reaped && WIFSIGNALED(status)) {
            throw Error(fmt::format("a worker process was killed by signal {} ({}); its rows are missing, so "
                                    "nothing was finished. Fewer worker processes need less memory",
                                    WTERMSIG(status), strsignal(WTERMSIG(status))),
                        {"jobs"});
        }
        throw Error(
            fmt::format("a worker process ended early with status {}; its rows are missing, so nothing "
                        "was finished",
                        reaped && WIFEXITED(status) ? WEXITSTATUS(status) : -1));
    }

    pid_t pid_ = -1;
    Descriptor socket_;
    SharedMemory results_;
};

class WorkerPool final : public RawRowProvider {
public:
    WorkerPool(std::unique_ptr<const EngineGeometry> geometry, const HemicubeSettings& settings,
               RowQuantity quantity, EngineSettings engine)
        : geometry_(std::move(geometry)), size_(geometry_->eyes.patches()), settings_(settings),
          quantity_(quantity), engine_(std::move(engine)), layout_(geometry_->patches, settings, quantity) {}

    [[nodiscard]] std::uint32_t size() const override { return size_; }

    [[nodiscard]] std::string renderer() const override {
        const_cast<WorkerPool*>(this)->start();
        return renderer_;
    }

    void rows(std::span<const std::uint32_t> patches, const Sink& sink) override {
        start();
        try {
            serve(patches, [&](std::uint32_t patch, const RawRow& row) {
                stop_if_interrupted();
                hemicubes_ += geometry_->eyes.of(patch).size();
                sink(patch, row);
            });
        } catch (...) {
            workers_.clear(); // whatever they still compute is not wanted
            throw;
        }
    }

    [[nodiscard]] std::uint64_t hemicubes() const override { return hemicubes_; }

private:
    void start() {
        if (!workers_.empty()) {
            return;
        }
        const std::string bytes = pack(*geometry_, settings_, quantity_, engine_.device);
        const SharedMemory geometry("hemi geometry", bytes.size());
        std::memcpy(geometry.data(), bytes.data(), bytes.size());
        std::uint32_t jobs =
            engine_.jobs != 0 ? engine_.jobs : std::max(1u, std::thread::hardware_concurrency());
        const std::uint32_t blocks =
            (size_ + FormFactorMatrix::block_rows - 1) / FormFactorMatrix::block_rows;
        jobs = std::min(jobs, std::max(1u, blocks)); // nobody gets less than a block
        const auto start_until = [&](std::uint32_t count) {
            while (workers_.size() < count) {
                workers_.emplace_back(engine_.worker_program.string(), geometry,
                                      result_slots * layout_.bytes());
            }
        };
        try {
            // Where it may turn out to be a GPU, one process asks first.
            start_until(gl::is_surely_software(engine_.device) ? jobs : 1);
            const FromWorker ready = workers_[0].receive();
            renderer_ = ready.text.data();
            if (ready.software == 0 && engine_.jobs == 0) {
                jobs = std::min(jobs, gpu_processes);
            }
            start_until(jobs);
            for (std::size_t i = 1; i < workers_.size(); ++i) {
                static_cast<void>(workers_[i].receive());
            }
        } catch (...) {
            workers_.clear();
            throw;
        }
    }

    /// Runs of patches within one block of the matrix each, in order.
    static std::vector<std::span<const std::uint32_t>> jobs_of(std::span<const std::uint32_t> patches) {
        std::vector<std::span<const std::uint32_t>> jobs;
        for (std::size_t begin = 0; begin < patches.size();) {
            const std::uint32_t block = patches[begin] / FormFactorMatrix::block_rows;
            std::size_t end = begin + 1;
            while (end < patches.size() && patches[end] / FormFactorMatrix::block_rows == block) {
                ++end;
            }
            jobs.push_back(patches.subspan(begin, end - begin));
            begin = end;
        }
        return jobs;
    }

    void serve(std::span<const std::uint32_t> patches, const Sink& sink) {
        const auto jobs = jobs_of(patches);
        std::size_t next = 0;
        std::size_t done = 0;
        const auto feed = [&](WorkerProcess& worker) {
            // One job ahead, so that a worker never waits for the next; but near the end nobody hoards what
            // another could begin.
            const auto at_once = [&] { return jobs.size() - next > workers_.size() ? 2u : 1u; };
            while (next < jobs.size() && worker.jobs < at_once()) {
                ToWorker message;
                message.count = static_cast<std::uint32_t>(jobs[next].size());
                std::copy(jobs[next].begin(), jobs[next].end(), message.patches.begin());
                worker.send(message);
                ++worker.jobs;
                ++next;
            }
        };
        std::vector<pollfd> waiting;
        for (WorkerProcess& worker : workers_) {
            feed(worker);
        }
        for (const WorkerProcess& worker : workers_) {
            waiting.push_back({worker.fd(), POLLIN, 0});
        }
        while (done < patches.size()) {
            constexpr int look_up_ms = 200;
            if (poll(waiting.data(), waiting.size(), look_up_ms) < 0 && errno != EINTR) {
                fail("poll");
            }
            stop_if_interrupted(); // also while a slow worker has nothing to say
            for (std::size_t w = 0; w < workers_.size(); ++w) {
                if (waiting[w].revents == 0) {
                    continue;
                }
                waiting[w].revents = 0;
                WorkerProcess& worker = workers_[w];
                const FromWorker chunk = worker.receive();
                if (chunk.job_done != 0) {
                    --worker.jobs;
                    feed(worker);
                }
                deliver(worker, chunk, sink);
                done += chunk.rows;
                ToWorker release;
                release.kind = ToWorker::Kind::release;
                release.count = chunk.slot;
                worker.send(release);
            }
        }
    }

    void deliver(const WorkerProcess& worker, const FromWorker& chunk, const Sink& sink) const {
        const RowHead* heads = layout_.heads(worker.results(), chunk.slot);
        const std::uint32_t* columns = layout_.columns(worker.results(), chunk.slot);
        const float* values = layout_.values(worker.results(), chunk.slot);
        const std::uint8_t* visibility = layout_.visibility(worker.results(), chunk.slot);
        for (std::uint32_t r = 0; r < chunk.rows; ++r) {
            RawRow row;
            row.columns = {columns, heads[r].entries};
            row.values = {values, heads[r].entries};
            if (visibility != nullptr) {
                row.visibility = {visibility, heads[r].entries};
                visibility += heads[r].entries;
            }
            row.environment = heads[r].environment;
            row.blocked = heads[r].blocked;
            sink(heads[r].patch, row);
            columns += heads[r].entries;
            values += heads[r].entries;
        }
    }

    std::unique_ptr<const EngineGeometry> geometry_;
    std::uint32_t size_;
    HemicubeSettings settings_;
    RowQuantity quantity_;
    EngineSettings engine_;
    ResultSlot layout_;
    std::vector<WorkerProcess> workers_;
    std::string renderer_;
    std::uint64_t hemicubes_ = 0;
};

} // namespace

std::unique_ptr<RawRowProvider> make_worker_pool(std::unique_ptr<const EngineGeometry> geometry,
                                                 const HemicubeSettings& settings, RowQuantity quantity,
                                                 const EngineSettings& engine) {
    return std::make_unique<WorkerPool>(std::move(geometry), settings, quantity, engine);
}

} // namespace hemi
