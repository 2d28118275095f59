#include "GenerateLook.h"

#include "SampleFile.h"
#include "Text.h"

#include "lattice/Error.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <filesystem>
#include <vector>

namespace lamella::cli
{
namespace
{

constexpr int nodesPerPixel = 4; // edges are smooth to a sixteenth of a pixel's light

const generators::LookOptions usual;

std::string micrometres(double metres)
{
  return fmt::format("{:g}um", metres * 1e6);
}

double lengthOrZero(const std::string& option, const std::string& text)
{
  return toNumber(text) == 0.0 ? 0 : lengthInMetres(option, text);
}

} // namespace

void addLookOptions(CLI::App& command, LookChoice& choice)
{
  choice.blur = micrometres(usual.blur);
  choice.noise = usual.noise;
  choice.unevenLight = usual.unevenLight;
  choice.dirt = usual.dirt;
  choice.tears = usual.tears;
  choice.rim = usual.rim;
  command.add_option("--look", choice.look, "Draw it as a micrograph with this stain, not as labels")
    ->type_name("magenta|blue|grey");
  command.add_option("--truth", choice.truth, "With --look: write the labels here")->type_name("FILE");
  command.add_option("--blur", choice.blur, "With --look: width of the optics' point spread; 0: none")
    ->type_name("METRES")
    ->capture_default_str();
  command.add_option("--noise", choice.noise, "With --look: standard deviation of the noise over full scale")
    ->type_name("SHARE")
    ->capture_default_str();
  command.add_option("--uneven-light", choice.unevenLight, "With --look: how much darker the darkest corner is")
    ->type_name("SHARE")
    ->capture_default_str();
  command.add_option("--dirt", choice.dirt, "With --look: specks of dirt a square millimetre")
    ->type_name("NUMBER")
    ->capture_default_str();
  command.add_option("--tears", choice.tears, "With --look: torn places a square millimetre")
    ->type_name("NUMBER")
    ->capture_default_str();
  command
    .add_option("--rim", choice.rim, "With --look: depth of a dark fringe along the lumens' edges, in stain of a wall")
    ->type_name("SHARE")
    ->capture_default_str();
  command.add_option("--scale-bar", choice.scaleBar, "With --look: length of a bar drawn into the picture; 0: none")
    ->type_name("METRES")
    ->capture_default_str();
}

std::optional<Look> parseLook(const CLI::App& command, const LookChoice& choice, const std::string& output,
  int dimension, std::uint64_t seed, std::function<PhaseImage(int finer)> tissue)
{
  if (choice.look.empty())
  {
    for (const char* const option :
      { "--truth", "--blur", "--noise", "--uneven-light", "--dirt", "--tears", "--rim", "--scale-bar" })
    {
      if (command.count(option) > 0)
      {
        throw ParameterError(fmt::format("{} is for micrographs, and labels are to be written", option),
          "add --look magenta, blue or grey");
      }
    }
    return std::nullopt;
  }
  const std::vector<std::string> stains{ "magenta", "blue", "grey" };
  Look look;
  look.options.stain = static_cast<generators::Stain>(oneOf("--look", choice.look, stains));
  if (dimension != 2)
  {
    throw ParameterError("--look draws cross-sections, and this sample is a volume", "give --size WIDTH,HEIGHT");
  }
  if (std::filesystem::path(output).extension() != ".png")
  {
    throw ParameterError("-o '" + output + "' cannot hold a micrograph", "end its name in .png");
  }
  if (!choice.truth.empty())
  {
    checkSampleEnding(choice.truth, dimension, "--truth");
    if (std::filesystem::path(choice.truth).lexically_normal() == std::filesystem::path(output).lexically_normal())
    {
      throw ParameterError("-o and --truth name the same file", "give the labels another name");
    }
  }
  look.stain = choice.look;
  look.truth = choice.truth;
  look.options.blur = lengthOrZero("--blur", choice.blur);
  look.options.noise = choice.noise;
  look.options.unevenLight = choice.unevenLight;
  look.options.dirt = choice.dirt;
  look.options.tears = choice.tears;
  look.options.rim = choice.rim;
  look.options.scaleBar = lengthOrZero("--scale-bar", choice.scaleBar);
  look.options.seed = seed;
  look.tissue = std::move(tissue);
  return look;
}

micrograph::Picture Look::draw() const
{
  return generators::makeLook(tissue(nodesPerPixel), nodesPerPixel, options);
}

nlohmann::ordered_json Look::toJson() const
{
  return { { "stain", stain }, { "blur", options.blur }, { "noise", options.noise },
    { "uneven_light", options.unevenLight }, { "dirt", options.dirt }, { "tears", options.tears },
    { "rim", options.rim }, { "scale_bar", options.scaleBar } };
}

} // namespace lamella::cli
