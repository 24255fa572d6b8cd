#pragma once

#include "hemi/core/names.hpp"
#include "hemi/engine/visibility_provider.hpp"
#include "hemi/matrix/form_factor_matrix.hpp"

#include <cstddef>
#include <cstdint>
#include <string_view>

namespace hemi {

struct Refinement;

/// What long work is at.
enum class Phase {
    visibility,     ///< hemicubes for visibilities; units are rows
    pairs,          ///< both directions of every pair are combined; units are rows
    form_factors,   ///< factors of all pairs, or plain rows; units are rows
    closure,        ///< rows are balanced; `done` is an estimate in per cent
    radiosity,      ///< sweeps; likewise
    gather,         ///< radiosity at vertices; units are vertices
    error_estimate, ///< better rows of a sample
    patch_size,     ///< what the patches' size does, on a sample; in per cent
    preview,        ///< a coarse solution; units are rows
    points,         ///< values at points; units are rows
};

/// Words of Phase, for people.
template <>
struct Names<Phase> {
    /// Every value with its word.
    static constexpr NamedValue<Phase> table[] = {{Phase::visibility, "visibility"},
                                                  {Phase::pairs, "combining pairs"},
                                                  {Phase::form_factors, "form factors"},
                                                  {Phase::closure, "closing rows"},
                                                  {Phase::radiosity, "solving"},
                                                  {Phase::gather, "gathering"},
                                                  {Phase::error_estimate, "comparing rows"},
                                                  {Phase::patch_size, "estimating the error"},
                                                  {Phase::preview, "coarse preview"},
                                                  {Phase::points, "points"}};
};

/// What long work tells, and asks, while it goes on. All calls come from the thread that started the work;
/// every function does nothing unless it is overridden.
class Observer {
public:
    virtual ~Observer() = default;

    /// `done` of `total` units of a phase are finished. Phases come one after the other.
    /// @return false to stop the work, which then throws Cancelled
    virtual bool progress(Phase phase, std::size_t done, std::size_t total);
    /// A row of plain form factors has come from the engine; rows come in any order. The view is valid during
    /// the call.
    virtual void row(std::uint32_t patch, const RowView& row);
    /// A row of visibilities has come, from which factors will be made once all are there. Valid during the
    /// call.
    virtual void row(std::uint32_t patch, const VisibilityRow& row);
    /// A mesh on the way of a refinement is solved, and its error estimated; valid during the call.
    /// @param so_far  with the form factors and the solution of the mesh; of gathered vertices some may show
    ///   the light of the mesh before
    virtual void refined(const Refinement& so_far);
    /// Something that a person should know and that does not stop the work.
    /// @param message  one sentence
    /// @param setting  name of a setting that would help, such as "max-memory"; empty: none
    virtual void warning(std::string_view message, std::string_view setting);
    /// Something that a person may like to know, such as rows that need not be computed again.
    virtual void note(std::string_view message);
    /// What interests who looks closely, such as costs that were foreseen.
    virtual void detail(std::string_view message);
};

/// An observer that does nothing.
[[nodiscard]] Observer& no_observer();

} // namespace hemi
