#include "scenes/Contents.h"

#include "session/Text.h"

#include <algorithm>
#include <cstddef>
#include <map>

namespace lamella::cli
{

namespace
{

/// "first_break{strain stress:Pa}": a key, those below it, and units.
const std::map<std::string, std::string>& reports()
{
  static const std::string model =
    " pairs{*{young critical_stretch fracture_energy toughness}} continuum poissons_ratio horizon micromodulus "
    "void_bonds surface_correction large_strains periodic thickness{*{median_nodes share_below_horizon}} loose_pieces "
    "loose_nodes hinges warnings";
  static const std::string run =
    " seconds peak_memory_bytes size refine pixel_size:m pixel_size_source phases threads ranks";
  static const std::string sizes = " nodes solid_nodes bonds strips{skipped uniform mixed} bytes" + run;
  static const std::string goesOn = " continued_at states_before checkpoints last_checkpoint";
  static const std::string platens = " load axis gauge_length:m section_area";
  static const std::map<std::string, std::string> all{
    { "diffusion",
      "effective{x y z} extrapolated{x y z} conducting_phase relative{x y z} formation_factor{x y z} "
      "tortuosity_factor{x y z} estimated_error estimated_errors{x y z} lattice_error lattice_errors{x y "
      "z} "
      "picture_error picture_errors{x y z} window_error window_errors{x y z} segmentation_errors{x y z} surface_doubt "
      "sensitivity{x{*} y{*} z{*}} input_errors{x y z} total_errors{x y z} target_error target tensor bounds{series "
      "parallel hashin_shtrikman} "
      "iterations setup_seconds solve_seconds method directions{x y z} window warnings segmentation lattice sides "
      "length tolerance balance solver_error nodes stored skipped solver_bytes conductivity_rounding membranes "
      "slice_distance:m" +
        run },
    { "fit",
      "of also unknown{*{value low high low_by_measurement high_by_measurement}} interval measured{*{value half_width "
      "fitted lattice_and_picture}} correlation misfit freedom chance solves seconds" },
    { "flux-map",
      "effective{x y z} tensor mean_flux tortuosity{x y z} tortuosity_factor{x y z} streamline_tortuosity{x y z} "
      "direction flux_magnitude{smallest largest mean} streamlines line_flux seconds" },
    { "pore-flood-fill",
      "phase connectivity periodic size unit pixel_size:m count largest mean total porosity window_errors{*} "
      "minimum_size dropped{count "
      "total} open{count share} closed{count share} percolates largest_pore{pore size equivalent_diameter:m window "
      "touches} distribution ranks seconds" },
    { "transient",
      "curve stepping lattice direction sides steps time_step:s relaxation stored_nodes skipped_nodes "
      "updates_per_second "
      "bytes warning ranks seconds" +
        goesOn },
    { "equilibrium",
      "effective_modulus:Pa effective_stress:Pa strain first_break{strain stress:Pa position phases} "
      "sensitivity{*{*}} relative_sensitivity{*{*}} input_errors{*} largest_stretch_ratio "
      "mean_stress{xx:Pa yy:Pa zz:Pa xy:Pa yz:Pa xz:Pa} reactions{low high} elastic_energy platen_layers{low high} "
      "pore_volume open_pore_nodes solver iterations "
      "newton_steps residual levels products bond_seconds load_seconds setup_seconds solve_seconds "
      "measure_seconds sensitivity_seconds" +
        platens + model + sizes },
    { "fracture",
      "peak_stress:Pa peak_strain peak_broken effective_modulus:Pa first_break{strain stress:Pa position phases} "
      "sensitivity{*{*}} relative_sensitivity{*{*}} input_errors{*} surface_doubt segmentation_errors{*} "
      "total_errors{*} window_errors{*} size_effect{exponent "
      "weibull_modulus} broken "
      "branches trough_stress:Pa trough_strain broken_by_pair broken_energy end end_reason states compression suction "
      "contact method breaking platen_layers{low high} "
      "pore_volume open_pore_nodes statistics" +
        goesOn + platens + model + sizes },
    { "dynamics",
      "peak_stress:Pa peak_strain peak_time:s peak_broken first_break_time:s broken broken_by_pair energies{kinetic "
      "elastic "
      "broken damped supplied initial} energy_defect end end_reason end_time:s states steps time_step:s stable_step:s "
      "viscosity mean_density:kg/m³ reference_energy compression effective_modulus:Pa small_strain_break "
      "strain_rate:1/s "
      "travel_time:s statistics" +
        goesOn + platens + model + sizes },
    { "compression",
      "strain stress:Pa axis sides worst_energy_ratio worst_energy_ratio_strain early_energy_ratio "
      "early_energy_ratio_strain calm_from worst_lateral worst_imbalance first_touch_strain wave_speed:m/s slowdowns "
      "steps "
      "states curve law plane walls points_per_node cells_per_node points grid_spacing:m cells_across_walls "
      "thin_wall_share warnings bytes_per_point updates_per_second setup_seconds run_seconds constants{*} components "
      "stiffness grid_nodes iterations residual solve_seconds" +
        goesOn + run },
    { "stiffness",
      "components stiffness extrapolated estimated_errors estimated_error error_leaves_out constants{E_*{value:Pa "
      "extrapolated:Pa estimated_error:Pa} "
      "G_*{value:Pa extrapolated:Pa estimated_error:Pa} *{value extrapolated estimated_error}} bounds{voigt reuss "
      "hashin_shtrikman{bulk shear}} isotropic{bulk:Pa shear:Pa young:Pa poisson rest} orthotropic{stiffness axes "
      "rest} sensitivity{*{*}} relative_sensitivity{*{*}} input_errors{*} surface_doubt segmentation_errors{*} "
      "total_errors{*} "
      "window_errors{*} expansion load{strain stress energy:J/m³ iterations} materials{*} continuum sides eigenvalues "
      "resisting "
      "asymmetry "
      "crosses{x y z} mismatch{x{seam layers} y{seam layers} z{seam layers}} pieces loose_pieces loose_nodes warnings "
      "iterations steps solver_error levels nodes solid_nodes bytes setup_seconds solve_seconds load_seconds "
      "estimate_seconds sensitivity_seconds" +
        run },
    { "bond-stiffness",
      "components stiffness extrapolated estimated_errors estimated_error error_leaves_out constants{E_*{value:Pa "
      "extrapolated:Pa estimated_error:Pa} "
      "G_*{value:Pa extrapolated:Pa estimated_error:Pa} *{value extrapolated estimated_error}} bounds{voigt reuss} "
      "eigenvalues resisting asymmetry crosses{x y z} mismatch{x{"
      "seam layers} y{seam layers} z{seam layers}} pieces iterations residual levels products steps bond_seconds "
      "setup_seconds solve_seconds measure_seconds estimate_seconds" +
        model + sizes },
    { "stress-pdf",
      "array component count mean:Pa deviation:Pa mean_tensile:Pa mean_compressive:Pa tensile_share compressive_share "
      "smallest:Pa "
      "largest:Pa reference:Pa tail{threshold count share theta theta_error distance} phases thresholds bins bin_width "
      "seconds" },
    { "crack-path",
      "phases_file dimension horizon broken_bonds cracks length:m main{length:m area:m² through start{x:m y:m} tip{x:m "
      "y:m} "
      "extension:m} "
      "through{x{length:m in_voids:m in_solid:m chord:m tortuosity} y{length:m in_voids:m in_solid:m chord:m "
      "tortuosity}} angle:° "
      "angle_spread:° left_out{cracks length:m spurs bonds faces} crushed_pieces area:m² counted_length:m "
      "counted_area:m² "
      "count_anisotropy "
      "normals paths pairs fragments{count largest_share severed} seconds" },
    { "compression-curve",
      "rows stiffness{value:Pa error:Pa intercept:Pa r2 toe low high rows} yield{strain stress:Pa} peak{strain "
      "stress:Pa} "
      "plateau{stress:Pa low high end_strain} densification{strain stress:Pa energy:J/m³ efficiency} energy:J/m³ "
      "missing seconds" },
    { "collapse-map", "points phase share lumens cut collapsed first_collapse_strain ratio states seconds" },
    { "snapshot", "range data_rectangle backend" },
  };
  return all;
}

/// Reads up to the brace that closes, which it leaves behind.
std::vector<ReportKeys> read(const std::string& text, std::size_t& at)
{
  std::vector<ReportKeys> keys;
  while (at < text.size())
  {
    const char c = text[at++];
    if (c == '}')
      break;
    if (c == '{')
    {
      keys.back().below = read(text, at);
      continue;
    }
    if (c == ' ')
      continue;
    const std::size_t end = text.find_first_of(" {}", at);
    const std::string word = text.substr(at - 1, end == std::string::npos ? end : end - at + 1);
    const std::size_t colon = word.find(':');
    keys.push_back({ word.substr(0, colon), colon == std::string::npos ? "" : word.substr(colon + 1), {} });
    at = end == std::string::npos ? text.size() : end;
  }
  return keys;
}

} // namespace

std::optional<std::vector<ReportKeys>> reportKeys(const std::string& command)
{
  const auto found = reports().find(command);
  if (found == reports().end())
    return std::nullopt;
  std::size_t at = 0;
  return read(found->second, at);
}

const ReportKeys* keyOf(const std::vector<ReportKeys>& keys, const std::string& name)
{
  const auto found = std::ranges::find_if(keys,
    [&](const ReportKeys& key)
    {
      const std::size_t star = key.name.find('*');
      return star == std::string::npos ? key.name == name : name.starts_with(key.name.substr(0, star));
    });
  return found == keys.end() ? nullptr : &*found;
}

std::string reportUnit(const std::string& command, const std::string& path)
{
  const std::vector<ReportKeys> all = reportKeys(command).value_or(std::vector<ReportKeys>{});
  const std::vector<ReportKeys>* level = &all;
  std::string unit;
  for (const std::string& element : split(path, '.'))
  {
    const ReportKeys* const key = keyOf(*level, element);
    if (key == nullptr)
      return "";
    unit = key->unit;
    level = &key->below;
  }
  return unit;
}

std::vector<std::string> arraysGiven(const std::string& command, const std::string& output)
{
  static const std::map<std::string, const char*> all{
    { "diffusion:output", "phase temperature concentration flux" },
    { "fit:output", "phase temperature concentration flux" },
    { "flux-map:output", "phase temperature concentration flux flux_magnitude" },
    { "transient:output", "phase temperature concentration flux" },
    { "equilibrium:output", "phase displacement stress strain_energy" },
    { "fracture:output", "phase damage broken displacement stress strain_energy" },
    { "dynamics:output", "phase damage broken displacement velocity stress strain_energy" },
    { "compression:output", "id phase displacement velocity stress deformation_gradient energy_density" },
    { "pore-flood-fill:output", "phase pore pore_size" },
    { "collapse-map:output", "phase lumen lumen_ratio collapse_strain" },
  };
  const auto found = all.find(command + ":" + output);
  return found == all.end() ? std::vector<std::string>{} : split(found->second, ' ');
}

} // namespace lamella::cli
