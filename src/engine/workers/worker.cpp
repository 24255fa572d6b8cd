#include "engine/hemicube/gl_rows.hpp"
#include "engine/workers/worker_wire.hpp"
#include "hemi/core/error.hpp"
#include "hemi/engine/engine.hpp"

#include <csignal>
#include <cstdlib>
#include <deque>

#include <sys/mman.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

namespace hemi {

namespace {

/// The program went away: nobody is left to work for.
struct Hangup {};

std::span<std::byte> map_whole(int fd, int protection) {
    struct stat status {};
    if (fstat(fd, &status) != 0) {
        throw Error("worker: started without its descriptors; it is not meant to be run by hand");
    }
    const auto size = static_cast<std::size_t>(status.st_size);
    void* memory = mmap(nullptr, size, protection, MAP_SHARED, fd, 0);
    if (memory == MAP_FAILED) {
        throw Error("worker: its memory cannot be mapped");
    }
    return {static_cast<std::byte*>(memory), size};
}

class Worker {
public:
    void run() {
        const UnpackedGeometry input = unpack(map_whole(worker_geometry_fd, PROT_READ));
        GlRows engine(input.geometry, input.settings, input.quantity, input.device);
        FromWorker ready;
        ready.kind = FromWorker::Kind::ready;
        ready.software = engine.software() ? 1 : 0;
        ready.set_text(engine.renderer());
        send(ready);

        const ResultSlot layout(input.geometry.patches, input.settings, input.quantity);
        std::byte* buffer = map_whole(worker_results_fd, PROT_READ | PROT_WRITE).data();
        for (;;) {
            while (jobs_.empty()) {
                receive();
            }
            const ToWorker job = jobs_.front();
            jobs_.pop_front();
            serve(engine, layout, buffer, std::span(job.patches.data(), job.count));
        }
    }

    static void send(const FromWorker& message) {
        if (::send(worker_socket_fd, &message, sizeof message, MSG_NOSIGNAL) != sizeof message) {
            throw Hangup{};
        }
    }

private:
    void receive() {
        ToWorker message;
        if (recv(worker_socket_fd, &message, sizeof message, 0) != sizeof message) {
            throw Hangup{};
        }
        if (message.kind == ToWorker::Kind::job) {
            jobs_.push_back(message);
        } else {
            busy_[message.count % result_slots] = false;
        }
    }

    void serve(GlRows& engine, const ResultSlot& layout, std::byte* buffer,
               std::span<const std::uint32_t> patches) {
        std::uint32_t rows = 0;
        std::size_t entries = 0;
        std::size_t done = 0;
        engine.rows(patches, [&](std::uint32_t patch, const RawRow& row) {
            while (busy_[slot_]) {
                receive();
            }
            layout.heads(buffer, slot_)[rows] = {patch, static_cast<std::uint32_t>(row.columns.size()),
                                                 row.environment, row.blocked};
            if (!row.columns.empty()) {
                std::memcpy(layout.columns(buffer, slot_) + entries, row.columns.data(),
                            row.columns.size_bytes());
                std::memcpy(layout.values(buffer, slot_) + entries, row.values.data(),
                            row.values.size_bytes());
                if (!row.visibility.empty()) {
                    std::memcpy(layout.visibility(buffer, slot_) + entries, row.visibility.data(),
                                row.visibility.size_bytes());
                }
            }
            entries += row.columns.size();
            ++rows;
            ++done;
            if (rows == layout.rows() || done == patches.size()) {
                FromWorker chunk;
                chunk.kind = FromWorker::Kind::chunk;
                chunk.slot = slot_;
                chunk.rows = rows;
                chunk.job_done = done == patches.size() ? 1 : 0;
                busy_[slot_] = true;
                slot_ = (slot_ + 1) % result_slots;
                rows = 0;
                entries = 0;
                send(chunk);
            }
        });
    }

    std::deque<ToWorker> jobs_;
    std::array<bool, result_slots> busy_{};
    std::uint32_t slot_ = 0;
};

} // namespace

int run_hemicube_worker() {
    struct stat state {};
    if (fstat(worker_socket_fd, &state) != 0 || !S_ISSOCK(state.st_mode)) {
        throw InvalidArgument(
            "this program is started by hemi, which talks to it; it does nothing by itself");
    }
    // Ctrl-C goes to the whole process group; the program decides, and takes its workers with it. A program
    // that vanishes is noticed at the next message.
    std::signal(SIGINT, SIG_IGN);
    // Software GL scales by process, not by thread; read when the first context is made.
    setenv("LP_NUM_THREADS", "0", 1);
    try {
        Worker().run();
    } catch (const Hangup&) {
        return EXIT_SUCCESS;
    } catch (const OtherBuild& error) {
        const std::string packet = refusal_packet(error);
        (void)::send(worker_socket_fd, packet.data(), packet.size(), MSG_NOSIGNAL);
        return EXIT_FAILURE;
    } catch (const std::exception& error) {
        FromWorker failed;
        failed.kind = FromWorker::Kind::failed;
        failed.no_device = dynamic_cast<const NoDevice*>(&error) != nullptr ? 1 : 0;
        failed.set_text(error.what());
        try {
            Worker::send(failed);
        } catch (const Hangup&) { // nobody listens
        }
        return EXIT_FAILURE;
    }
    return EXIT_SUCCESS;
}

} // namespace hemi
