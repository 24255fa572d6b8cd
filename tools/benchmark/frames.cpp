#include "benchmark/frames.hpp"

#include "benchmark/cases.hpp"
#include "benchmark/timing.hpp"
#include "display/orbit_camera.hpp"
#include "display/picture_renderer.hpp"
#include "gl/context.hpp"
#include "gl/objects.hpp"
#include "hemi/core/error.hpp"

#include <fmt/format.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <memory>

namespace hemi::bench {

namespace {

constexpr std::uint32_t patches = 10000;
constexpr std::uint32_t width = 1280;
constexpr std::uint32_t height = 720;
constexpr double least_software = 15.0;
constexpr double least_gpu = 60.0;

/// Seconds of each frame of a turn about the room.
Series frames(PictureRenderer& renderer, const PatchMesh& mesh, GLuint target, std::uint32_t samples,
              int count) {
    const Bounds& bounds = mesh.bounds();
    const Vec3 size = bounds.upper - bounds.lower;
    const Camera inside{bounds.lower + 0.1 * size, bounds.centre(), {0.0, 0.0, 1.0}, 60.0};
    OrbitCamera orbit(inside, bounds);
    PictureSettings settings;
    settings.width = width;
    settings.height = height;
    settings.samples = samples;
    Series seconds;
    for (int k = 0; k < count; ++k) {
        const auto start = std::chrono::steady_clock::now();
        orbit.grab(inside.target);
        orbit.orbit(0.02, 0.0);
        renderer.draw(orbit.camera(), settings, target);
        glFinish();
        seconds.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count());
    }
    seconds.erase(seconds.begin()); // makes textures and programs ready
    return seconds;
}

} // namespace

int run_frames(const std::string& device, const std::filesystem::path& mesh) {
    const auto context = gl::make_context(device);
    const Case shown = mesh.empty() ? make_room(patches) : read_case(mesh);
    std::vector<double> radiosity;
    for (std::uint32_t i = 0; i < shown.mesh.size(); ++i) {
        radiosity.push_back(0.2 + 0.001 * (i % 500)); // what the pixels show does not matter
    }
    PictureRenderer renderer;
    renderer.upload(make_picture_mesh(shown.mesh, 1, radiosity, {}, {0, 0, 0}));
    const gl::Texture2D picture;
    glTextureStorage2D(picture.get(), 1, GL_RGBA8, width, height);
    const gl::Framebuffer target;
    glNamedFramebufferTexture(target.get(), GL_COLOR_ATTACHMENT0, picture.get(), 0);
    const double moving = median(frames(renderer, shown.mesh, target.get(), 1, 61));
    const double resting = median(frames(renderer, shown.mesh, target.get(), PictureSettings{}.samples, 11));
    fmt::print("{} {} {} {}\n", moving, resting, context->software() ? 1 : 0, shown.mesh.size());
    return EXIT_SUCCESS;
}

void frame_target(const std::filesystem::path& bench, const std::string& device, Report& report) {
    const std::string command =
        fmt::format("env -u LP_NUM_THREADS '{}' {} '{}'", bench.string(), frames_argument, device);
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> output(popen(command.c_str(), "r"), pclose);
    std::array<char, 256> line{};
    double moving = 0.0;
    double resting = 0.0;
    int software = 0;
    unsigned count = 0;
    if (!output || std::fgets(line.data(), static_cast<int>(line.size()), output.get()) == nullptr ||
        std::sscanf(line.data(), "%lf %lf %d %u", &moving, &resting, &software, &count) != 4) {
        throw Error("frames could not be timed");
    }
    const std::string what = fmt::format("{} patches, {} x {}", count, width, height);
    if (software != 0) {
        report.finding(
            {fmt::format("window while it moves (1 sample a pixel; aim on a GPU: {:.0f} with 16), {}",
                         least_gpu, what),
             1.0 / moving, "frames/s", Bound::at_least, least_software});
        report.finding({fmt::format("picture at rest (16 samples a pixel), {}", what), resting, "s"});
        return;
    }
    report.finding({fmt::format("window (16 samples a pixel), {}", what), 1.0 / resting, "frames/s",
                    Bound::at_least, least_gpu});
}

} // namespace hemi::bench
