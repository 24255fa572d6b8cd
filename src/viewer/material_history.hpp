#pragma once

#include "hemi/scene/scene.hpp"

#include <cstddef>
#include <utility>
#include <vector>

namespace hemi::viewer {

/// What the user has made of a scene's materials, temperatures and environment, step by step.
class MaterialHistory {
public:
    struct State {
        std::vector<Material> materials;
        std::vector<HeatCondition> conditions;
        std::vector<double> environment;

        bool operator==(const State&) const = default;
    };

    /// @param opened  as the scene was opened
    explicit MaterialHistory(State opened) : states_{std::move(opened)} {}

    /// A change is complete; the same state again is none. What was undone before is forgotten.
    /// @return whether there was a change
    bool note(State now) {
        if (now != states_[at_]) {
            states_.resize(at_ + 1);
            states_.push_back(std::move(now));
            ++at_;
            return true;
        }
        return false;
    }
    /// One step back, or none at the first state.
    const State& undo() { return states_[at_ > 0 ? --at_ : 0]; }
    /// One step forward of those that were undone.
    const State& redo() { return states_[at_ + 1 < states_.size() ? ++at_ : at_]; }

private:
    std::vector<State> states_;
    std::size_t at_ = 0;
};

} // namespace hemi::viewer
