#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace hemi::gl {

/// An offscreen OpenGL 4.5 core context, current on the thread that made it until another one is.
/// Destroy GL objects before their context, with the context current.
class Context {
public:
    virtual ~Context() = default;
    Context(const Context&) = delete;
    Context& operator=(const Context&) = delete;

    /// Makes the context current on the calling thread and (re)loads the GL functions if they belong to
    /// another kind of context. @throws GlError
    virtual void make_current() = 0;

    /// The name by which `--device` chooses it: "egl:0", "osmesa", "window".
    [[nodiscard]] const std::string& name() const noexcept { return name_; }
    [[nodiscard]] const std::string& renderer() const noexcept { return renderer_; }
    [[nodiscard]] const std::string& version() const noexcept { return version_; }
    /// Whether it rasterises on the CPU.
    [[nodiscard]] bool software() const noexcept { return software_; }

protected:
    Context() = default;
    /// To be called when the context is current and the functions are loaded: reads the strings and the
    /// version, checks that it suffices, and records errors from then on where debug_wanted().
    /// @throws NoDevice
    void describe(std::string name);

private:
    void record_errors();

    std::string name_;
    std::string renderer_;
    std::string version_;
    bool software_ = true;
    std::string recorded_; ///< what the driver said of the first error since the last check_errors()
};

/// Whether contexts are made as debug contexts and record what the driver says of errors: the environment
/// variable HEMI_GL_DEBUG is set, and not to 0. Programs that this one starts inherit it.
[[nodiscard]] bool debug_wanted();

/// @param device  auto (a GPU if there is one, else OSMesa), egl (the first EGL device that works), egl:N,
/// osmesa. A named device never falls back to another.
/// @throws InvalidArgument for another name; NoDevice with the reasons if it cannot be had.
[[nodiscard]] std::unique_ptr<Context> make_context(const std::string& device);

/// The name of the first hardware device that a context can be made on; none without a GPU.
[[nodiscard]] std::optional<std::string> find_gpu();

/// @throws InvalidArgument unless `device` is a name that make_context() knows.
void check_device_name(const std::string& device);

/// Whether `device` rasterises on the CPU as far as can be told without making a context; false if in doubt.
[[nodiscard]] bool is_surely_software(const std::string& device);

/// Names of all devices that could be tried here: "egl:0" …, "osmesa".
[[nodiscard]] std::vector<std::string> device_names();

/// Loads GL functions through `loader` and remembers under `backend` which kind of context they belong to;
/// does nothing if they are loaded for that backend already. For contexts made elsewhere (a window).
/// @throws GlError
void load_functions(const char* backend, void (*(*loader)(const char*))());

/// What made the functions' loader: "glad 2.0.2".
[[nodiscard]] const char* loader_version() noexcept;

/// Throws GlError naming `where` if the current context has a pending error, or has recorded one; with the
/// driver's own message if it has. The context has neither afterwards.
void check_errors(const char* where);

} // namespace hemi::gl
