#include "reports/Samples.h"

#include "reports/Chart.h"
#include "reports/Folder.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <set>
#include <utility>

namespace lamella::reports
{

namespace fs = std::filesystem;

std::string SweptKey::text(std::size_t value) const
{
  return name + " " + values[value] + (unit.empty() ? "" : " " + unit);
}

Samples::Samples(const fs::path& folder)
  : table_(requireWithin(folder, folder / "table.csv"))
  , key_(table_.column("sample"))
  , status_(table_.column("status"))
{
  std::set<std::string> settings; // what samples are not averaged over
  std::error_code none;
  const bool told = fs::exists(folder / "settings.csv", none);
  if (told)
  {
    const DataTable means(requireWithin(folder, folder / "settings.csv"));
    settings.insert(means.names().begin(), std::ranges::find(means.names(), "n"));
  }
  for (std::size_t column = key_ + 1; column < status_; ++column)
  {
    SweptKey key = keyOf(column);
    key.averaged = told ? !settings.contains(key.path) : key.path.ends_with(".seed");
    if (key.values.size() > 1)
      keys_.push_back(std::move(key));
  }
  if (std::ranges::all_of(keys_, &SweptKey::averaged)) // nothing to show means over: the samples themselves, in a row
  {
    for (SweptKey& key : keys_)
    {
      key.averaged = key.numbers = false;
      std::iota(key.coordinates.begin(), key.coordinates.end(), 0.0);
    }
  }
  const auto inner = [](const SweptKey& key) { return key.path.substr(key.path.find('.') + 1); };
  for (SweptKey& key : keys_)
    key.name = std::ranges::count(keys_, inner(key), inner) > 1 ? key.path : inner(key);
  for (std::size_t column = status_ + 1; column < table_.names().size(); ++column)
    if (table_.isNumeric(column))
      measures_.push_back(column);
}

SweptKey Samples::keyOf(std::size_t column) const
{
  const std::string& path = table_.names()[column];
  const bool numbers = std::ranges::all_of(table_.numbers(column), [](double one) { return std::isfinite(one); });
  SweptKey key{ path, "", table_.unit(path), numbers };
  std::map<std::string, std::size_t> known;
  for (std::size_t row = 0; row < table_.rows(); ++row)
  {
    const std::string cell = table_.text(row, column);
    const auto [at, added] = known.try_emplace(cell, key.values.size());
    if (added)
    {
      const double number = table_.number(row, column);
      key.values.push_back(key.numbers ? numberText(number) : cell);
      key.coordinates.push_back(key.numbers ? number : static_cast<double>(at->second));
    }
    key.ofRow.push_back(at->second);
  }
  return key;
}

std::string Samples::caption(std::size_t row) const
{
  std::string text;
  for (const SweptKey& key : keys_)
    text += (text.empty() ? "" : ", ") + key.text(key.ofRow[row]);
  return text;
}

std::vector<std::string> Samples::captions(const std::vector<std::size_t>& rows) const
{
  std::vector<std::string> texts(rows.size());
  for (const SweptKey& key : keys_)
  {
    const bool same =
      std::ranges::all_of(rows, [&](std::size_t row) { return key.ofRow[row] == key.ofRow[rows.front()]; });
    for (std::size_t i = 0; i < rows.size() && !same; ++i)
      texts[i] += (texts[i].empty() ? "" : ", ") + key.text(key.ofRow[rows[i]]);
  }
  return texts;
}

std::vector<std::size_t> Samples::some(std::size_t most) const
{
  std::vector<std::size_t> repeats; // how many samples of the same setting come before each
  std::map<std::vector<std::size_t>, std::size_t> settings;
  for (std::size_t row = 0; row < table_.rows(); ++row)
  {
    std::vector<std::size_t> setting;
    for (const SweptKey& key : keys_)
      if (!key.averaged)
        setting.push_back(key.ofRow[row]);
    repeats.push_back(settings[setting]++);
  }
  const std::size_t sets = std::max<std::size_t>(1, most / std::max<std::size_t>(1, settings.size()));
  std::vector<std::size_t> rows;
  for (std::size_t row = 0; row < repeats.size(); ++row)
    if (repeats[row] < sets)
      rows.push_back(row);
  if (rows.size() <= most)
    return rows;
  std::vector<std::size_t> evenly;
  for (std::size_t i = 0; i < most; ++i)
    evenly.push_back(rows[i * rows.size() / most]);
  return evenly;
}

} // namespace lamella::reports
