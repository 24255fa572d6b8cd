#include "gl/contexts.hpp"

// Before osmesa.h, which pulls in the old GL header otherwise.
#include <glad/gl.h>

#include "hemi/core/error.hpp"

#include <GL/osmesa.h>

#include <array>

namespace hemi::gl {

namespace {

/// Mesa's software rasteriser without any window system.
class OsmesaContext final : public Context {
public:
    OsmesaContext() {
        const std::array<int, 13> attributes{OSMESA_FORMAT,
                                             OSMESA_RGBA,
                                             OSMESA_DEPTH_BITS,
                                             0,
                                             OSMESA_STENCIL_BITS,
                                             0,
                                             OSMESA_PROFILE,
                                             OSMESA_CORE_PROFILE,
                                             OSMESA_CONTEXT_MAJOR_VERSION,
                                             4,
                                             OSMESA_CONTEXT_MINOR_VERSION,
                                             5,
                                             0};
        context_ = OSMesaCreateContextAttribs(attributes.data(), nullptr);
        if (context_ == nullptr) {
            throw NoDevice("osmesa: OSMesaCreateContextAttribs (OpenGL 4.5 core) failed");
        }
        try {
            OsmesaContext::make_current();
            describe("osmesa");
        } catch (...) {
            OSMesaDestroyContext(context_);
            throw;
        }
    }

    ~OsmesaContext() override { OSMesaDestroyContext(context_); }

    void make_current() override {
        if (OSMesaMakeCurrent(context_, client_buffer_.data(), GL_UNSIGNED_BYTE, 1, 1) != GL_TRUE) {
            throw NoDevice("osmesa: OSMesaMakeCurrent failed");
        }
        load_functions("osmesa", OSMesaGetProcAddress);
    }

private:
    OSMesaContext context_ = nullptr;
    // Mesa insists on a client buffer, even where only framebuffer objects are drawn to.
    std::array<unsigned char, 16> client_buffer_{};
};

} // namespace

std::unique_ptr<Context> make_osmesa_context() {
    return std::make_unique<OsmesaContext>();
}

} // namespace hemi::gl
