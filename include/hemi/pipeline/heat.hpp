#pragma once

#include "hemi/matrix/form_factors.hpp"
#include "hemi/pipeline/observer.hpp"
#include "hemi/pipeline/settings.hpp"
#include "hemi/scene/patch_mesh.hpp"
#include "hemi/solver/solution.hpp"

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace hemi {

/// What patches are as far as heat goes. Arrays of N·bands hold band k of patch i at [i·bands + k].
struct HeatProblem {
    std::vector<double> band_limits; ///< µm, one less than there are bands
    std::uint32_t bands = 1;         ///< wavelength bands; 1: grey
    std::vector<double> emissivity;  ///< N·bands, in [0, 1]; where there is a table, at 300 K
    std::vector<double> exitance;    ///< radiated beside what the temperature makes, W/m², N·bands
    std::vector<std::vector<std::array<double, 2>>>
        tables;                            ///< emissivity by temperature; see Material::emissivity_table
    std::vector<std::uint32_t> table_of;   ///< N, index into `tables` or no_heat
    std::vector<HeatCondition> conditions; ///< what is known of the heat
    std::vector<std::uint32_t>
        condition_of; ///< N, index into `conditions`; no_heat: radiates `exitance` only
    std::optional<double> environment_temperature; ///< K
    std::vector<double> environment;               ///< exitance of the environment beside that, W/m², bands
    double unit = 1.0;                             ///< metres in a unit of the areas' lengths
    std::vector<double> direct{}; ///< irradiance from sun and sky, W/m², N·bands, >= 0; empty: neither
};

/// That of a scene, without what comes from sun and sky: that needs rows, see direct_heat().
/// @param scene     with emissivities (1 - reflectance), conditions and exitances
/// @param mesh      its patches
/// @param observer  gets warnings: of groups of which nothing is known, of temperatures that look like °C, of
///   lengths that look like millimetres
/// @param conditions  whether temperatures and fluxes are of interest, and warnings of them
/// @throws InputError where channels are neither the bands nor equal, in materials that surfaces use; with
///   `conditions` for a scene in lumens
[[nodiscard]] HeatProblem heat_problem(const Scene& scene, const PatchMesh& mesh,
                                       Observer& observer = no_observer(), bool conditions = true);

/// How far a problem is solved.
struct HeatSettings {
    double tolerance = 1e-11;       ///< relative residual of J = s + (1 - eps) G, of every linear system
    double outer_tolerance = 1e-10; ///< largest change of a sigma T⁴ over the largest, in outer iterations
    std::uint32_t max_outer = 500;  ///< outer iterations at most
};

/// Temperatures and fluxes of all patches. Arrays of N·bands hold band k of patch i at [i·bands + k]; others
/// are over all bands.
struct HeatSolution {
    std::uint32_t bands = 1;         ///< as in the problem
    std::vector<double> temperature; ///< K, N; not a number where nothing tells it
    /// J, W/m², N·bands; not a number of buried patches without a known temperature.
    std::vector<double> radiosity;
    std::vector<double> irradiation;  ///< G, W/m², N·bands; as J
    std::vector<double> emitted;      ///< eps f sigma T⁴ + exitance, W/m², N; as J
    std::vector<double> absorbed;     ///< eps G, W/m², N; as J
    std::vector<double> net_flux;     ///< J - G, leaving positive, W/m², N
    std::vector<std::uint8_t> buried; ///< N; 1: sees nothing, has no flux, and is left out of means
    double environment_power = 0.0;   ///< W, leaving the environment positive
    double balance = 0.0;             ///< W, all net powers and the environment's together: 0 but for errors
    double relative_balance = 0.0;    ///< that over the sum of the magnitudes of all net powers
    std::uint32_t iterations = 0;     ///< of conjugate gradients, in all
    std::uint32_t outer = 0;          ///< outer iterations; 0: none were needed
    double outer_change = 0.0;        ///< last largest change of a sigma T⁴ over the largest
    double residual = 0.0;            ///< of the linear systems, the worst
    /// Of rows with clusters: how far what a patch exchanges with all others was from what its row says, a
    /// share of this, rms by area, once that was made symmetric and before it was scaled. 0 without clusters.
    double asymmetry = 0.0;
    /// Of rows with clusters: by how much G, over all bands, would change if what arrives at the patches were
    /// what their rows say: to the first order, W/m², N. Empty without clusters, and of lines of a series.
    std::vector<double> asymmetry_change;
};

/// Net fluxes and temperatures by J = eps f(T) sigma T⁴ + exitance + (1 - eps) G, G = F J + b J + e J_env + D
/// in every band: what of a row meets back faces comes back, so that buried patches have no flux. Where the
/// flux is given, J = G + q, and T follows. One linear solve a band by conjugate gradients on the symmetric
/// system; several bands with fluxes, isothermal groups and emissivities by temperature by fixed-point
/// iterations with Anderson's acceleration around it. In closed scenes leaks come back, too. Source: D. G.
/// Anderson, "Iterative procedures for nonlinear integral equations", J. ACM 12, 1965.
/// @param factors   all rows known, and reciprocal or with clusters: of these, the mean of A F and its
///   transpose counts, in which a cluster gives what it gets on to its patches by their weights, scaled to
///   what the rows exchange
/// @param problem   of the same patches
/// @param settings  tolerances
/// @param observer  gets progress and may cancel; gets a warning where an open scene's environment has no
///   temperature, and where one is given that no surface sees
/// @throws InvalidArgument for rows that are not reciprocal or unknown, and sizes that differ; InputError
/// where
///   nothing holds the temperature of an enclosure, naming its groups, where a flux would need temperatures
///   below 0 K, where one is given in bands or isothermally that an emissivity of 0 does not allow, and where
///   a power is that of buried patches only; NotConverged; Cancelled
[[nodiscard]] HeatSolution solve_heat(const FormFactors& factors, const HeatProblem& problem,
                                      const HeatSettings& settings = {}, Observer& observer = no_observer());

/// What solve_heat() found, as patch_quantity() takes it: radiosity J, irradiance G, exitance J - (1 - eps)
/// G, temperature, net flux and the rows' balance.
/// @param factors   as in solve_heat()
/// @param problem   as in solve_heat()
/// @param solution  of the problem
/// @param channels  of the scene: one for every band, or equal ones of a grey problem
[[nodiscard]] Solution heat_as_solution(const FormFactors& factors, const HeatProblem& problem,
                                        const HeatSolution& solution, std::uint32_t channels);

/// A scene as a `.hres` of heat_as_solution() holds it: its environment radiates by its temperature, too, and
/// nothing else is said of heat but the bands.
/// @param scene    that the problem is of
/// @param problem  one band for every channel, or one
[[nodiscard]] Scene scene_of_heat(Scene scene, const HeatProblem& problem);

/// What is known of a group: means over the area that is not buried; not a number where all is, but for the
/// emissivity, which is none of a group without patches.
struct GroupHeat {
    double area = 0.0;       ///< m², all of it
    double emissivity = 0.0; ///< of all bands: emitted by the temperature over sigma T⁴; mean where T is
                             ///< unknown or all is buried
    double temperature = 0.0; ///< K, of the mean of sigma T⁴; not a number where it is not known of all of it
    double emitted = 0.0;     ///< W/m²
    double absorbed = 0.0;    ///< W/m²
    double irradiation = 0.0; ///< W/m²
    double direct = 0.0;      ///< of the irradiation what comes straight from sun and sky, W/m²
    double radiosity = 0.0;   ///< W/m²
    double net_flux = 0.0;    ///< W/m², leaving positive
    double net_power = 0.0;   ///< W, leaving positive
    /// Of the net flux, W/m²: what the form factors' estimated error brings where the temperature is given, 0
    /// where the flux is. Not a number where that is not known. With clusters, what making their exchange
    /// symmetric changes is a part of it.
    double flux_error = 0.0;
};
/// Of every group of the form factors; a last one with everything but the environment.
[[nodiscard]] std::vector<GroupHeat> group_heat(const FormFactors& factors, const HeatProblem& problem,
                                                const HeatSolution& solution);

/// What the mean net flux of every group is off by because patches have a size, W/m², estimated as by
/// estimate_patch_size_error() for the light that goes from patch to patch. 0 where the flux is given; not a
/// number where it is not known.
/// @param scene        that the problem is of
/// @param mesh         its patches
/// @param subdivision  by which PatchMesh(scene, subdivision) has these patches
/// @param factors      all rows
/// @param problem      of the mesh
/// @param solution     of the problem
/// @param settings     as in estimate_patch_size_error()
/// @param observer     gets progress and may cancel; gets a warning where it cannot be estimated
[[nodiscard]] std::vector<double>
patch_size_flux_errors(const Scene& scene, const PatchMesh& mesh, const Subdivision& subdivision,
                       const FormFactors& factors, const HeatProblem& problem, const HeatSolution& solution,
                       const FactorSettings& settings, Observer& observer = no_observer());

/// What changes with time: a column for each of some groups, or for the environment.
struct HeatSchedule {
    std::vector<std::string> columns; ///< names of groups, or "environment"
    /// Line l, column c at [l·columns + c]: temperatures, K; of groups with a heat flux that, W/m²; of groups
    /// with a power that, W.
    std::vector<double> values;
    std::vector<std::string> labels;   ///< of lines, for messages; none: they have their numbers only
    std::vector<std::size_t> places{}; ///< of lines in their file, for messages; none: counted from 1
};
/// What a column of a schedule gives.
enum class HeatQuantity { temperature, heat_flux, power };
/// Looks through a schedule before any work is done with it. Warns of columns that look like °C.
/// @param groups    names
/// @param group_of  N, of every patch
/// @param problem   of the same patches
/// @param schedule  no values need be there yet
/// @param observer  gets warnings
/// @return what every column gives
/// @throws InvalidArgument, InputError as solve_heat_series() for names and values
[[nodiscard]] std::vector<HeatQuantity> check_heat_schedule(const std::vector<std::string>& groups,
                                                            std::span<const std::uint32_t> group_of,
                                                            const HeatProblem& problem,
                                                            const HeatSchedule& schedule,
                                                            Observer& observer = no_observer());
/// What comes of a schedule, line by line. Arrays of lines·groups hold group g of line l at [l·groups + g].
struct HeatSeries {
    std::uint32_t groups = 0;              ///< their number
    std::vector<double> temperature;       ///< as in GroupHeat
    std::vector<double> net_flux;          ///< as in GroupHeat
    std::vector<double> net_power;         ///< as in GroupHeat
    std::vector<double> environment_power; ///< W, a line
    bool superposed = false; ///< by one solve a column; else by one a line, since the problem is not linear
};
/// Solves for every line of a schedule, which replaces what the problem says of these groups: all of their
/// temperatures, fluxes or powers; groups of which it says nothing get temperatures.
/// @param factors   as in solve_heat()
/// @param problem   as in solve_heat()
/// @param schedule  temperatures, fluxes and powers
/// @param settings  tolerances
/// @param observer  gets progress and may cancel
/// @throws InputError for unknown groups, with the nearest, repeated columns, groups with conditions of
/// several
///   kinds, and temperatures below 0 K; as solve_heat(), with the line
[[nodiscard]] HeatSeries solve_heat_series(const FormFactors& factors, const HeatProblem& problem,
                                           const HeatSchedule& schedule, const HeatSettings& settings = {},
                                           Observer& observer = no_observer());

/// Grey exchange between groups with all reflections. Arrays of G·G hold g, h at [g·G + h].
struct HeatExchange {
    std::vector<double> areas;      ///< m², G
    std::vector<double> emissivity; ///< area mean, G
    std::vector<double> gebhart; ///< share of what g emits that h absorbs in the end; 0 where g emits nothing
    std::vector<double> script_f;    ///< sum A_i eps_i B_ij over g and h over A_g, the diagonal included
    std::vector<double> conductance; ///< A_g script_f, m², symmetric
    std::vector<double> environment; ///< script-F to the environment, G
    double asymmetry = 0.0;          ///< as in HeatSolution
};
/// Exchange factors by the emissivities alone, whatever is known of temperatures and fluxes: the net power
/// from g to h is conductance·sigma (T_g⁴ - T_h⁴). One column of a linear solve a group. Source: B. Gebhart,
/// "Surface temperature calculations in radiant surroundings of arbitrary complexity", Int. J. Heat Mass
/// Transfer 3, 1961; H. C. Hottel, A. F. Sarofim, "Radiative Transfer", 1967.
/// @param factors   as in solve_heat()
/// @param problem   grey
/// @param settings  tolerance
/// @param observer  gets progress and may cancel
/// @throws InputError for several bands, and emissivities by temperature; as solve_heat()
[[nodiscard]] HeatExchange heat_exchange(const FormFactors& factors, const HeatProblem& problem,
                                         const HeatSettings& settings = {},
                                         Observer& observer = no_observer());

/// What leaving out small conductances did.
struct ExchangeCutoff {
    double min = 0.0;            ///< m², what every conductance between groups is at least, unless it is 0
    std::uint64_t dropped = 0;   ///< pairs that were left out, those with the environment too
    std::uint64_t kept = 0;      ///< pairs that are left, likewise
    double largest_share = 0.0;  ///< of what a group emits, that it gave to what was left out, the largest
    double largest_change = 0.0; ///< of a conductance that is kept, over what it was, the largest
    std::vector<std::uint32_t> isolated; ///< groups that are left with themselves alone, and were not before
};
/// Leaves out conductances between groups, and of groups with the environment, that are below a value, and
/// gives what they carried to those that are kept: K' = D (K + S) D with a diagonal D by which every row,
/// the environment's too, has the sum that it had. S is diagonal: the share of a row that was dropped,
/// squared, times its sum, so that there is such a D whatever is dropped, and of what little is dropped next
/// to nothing goes to the group itself. What falls below the value is left out as well. What groups absorb
/// of their own, the diagonal, is not dropped. Source: scaling of symmetric matrices to given row sums, R.
/// Sinkhorn, P. Knopp, Pacific J. Math. 21, 1967; here by Newton's method.
/// @param exchange  changed in place; symmetric and balanced as it was, and not below 0
/// @param min       m², above 0
/// @throws InvalidArgument for another `min`; NotConverged
ExchangeCutoff drop_small_conductances(HeatExchange& exchange, double min);

} // namespace hemi
