#include "hemi/pipeline/observer.hpp"

namespace hemi {

bool Observer::progress(Phase, std::size_t, std::size_t) {
    return true;
}

void Observer::row(std::uint32_t, const RowView&) {}

void Observer::row(std::uint32_t, const VisibilityRow&) {}

void Observer::refined(const Refinement&) {}

void Observer::warning(std::string_view, std::string_view) {}

void Observer::note(std::string_view) {}

void Observer::detail(std::string_view) {}

Observer& no_observer() {
    static Observer silent;
    return silent;
}

} // namespace hemi
