#include "reports/Html.h"

#include "reports/Style.h"

#include <vtkBase64Utilities.h>

#include <cmark.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <vector>

namespace lamella::reports
{

namespace
{

/// Length of the UTF-8 sequence that begins here, or 0 where none does (RFC 3629: no overlong forms, no surrogates).
std::size_t sequence(std::string_view text)
{
  const auto byte = [&](std::size_t i) { return static_cast<std::uint8_t>(text[i]); };
  const std::uint8_t first = byte(0);
  const std::size_t length = first < 0x80 ? 1
    : first < 0xc2                        ? 0
    : first < 0xe0                        ? 2
    : first < 0xf0                        ? 3
    : first < 0xf5                        ? 4
                                          : 0;
  if (length == 0 || length > text.size())
    return 0;
  for (std::size_t i = 1; i < length; ++i)
    if ((byte(i) & 0xc0) != 0x80)
      return 0;
  const bool wrong = (first == 0xe0 && byte(1) < 0xa0) || (first == 0xed && byte(1) > 0x9f) ||
    (first == 0xf0 && byte(1) < 0x90) || (first == 0xf4 && byte(1) > 0x8f);
  return wrong ? 0 : length;
}

using Node = std::unique_ptr<cmark_node, decltype(&cmark_node_free)>;

bool leadsOut(const char* url)
{
  const std::string_view text = url == nullptr ? "" : url;
  return text.starts_with("http://") || text.starts_with("https://") || text.starts_with("#");
}

/// Puts the children of a node in its place.
void unwrap(cmark_node* node)
{
  while (cmark_node* const child = cmark_node_first_child(node))
    cmark_node_insert_before(node, child);
  cmark_node_free(node);
}

/// Raw HTML becomes text, pictures and links that lead nowhere their words.
void tame(cmark_node* document)
{
  std::vector<cmark_node*> nodes;
  const std::unique_ptr<cmark_iter, decltype(&cmark_iter_free)> walk(cmark_iter_new(document), cmark_iter_free);
  for (cmark_event_type event = cmark_iter_next(walk.get()); event != CMARK_EVENT_DONE;
       event = cmark_iter_next(walk.get()))
    if (event == CMARK_EVENT_ENTER)
      nodes.push_back(cmark_iter_get_node(walk.get()));
  for (cmark_node* const node : nodes)
  {
    const cmark_node_type type = cmark_node_get_type(node);
    if (type == CMARK_NODE_HTML_INLINE || type == CMARK_NODE_HTML_BLOCK)
    {
      cmark_node* const text = cmark_node_new(CMARK_NODE_TEXT);
      cmark_node_set_literal(text, cmark_node_get_literal(node));
      cmark_node* shown = text;
      if (type == CMARK_NODE_HTML_BLOCK)
      {
        shown = cmark_node_new(CMARK_NODE_PARAGRAPH);
        cmark_node_append_child(shown, text);
      }
      cmark_node_replace(node, shown);
      cmark_node_free(node);
    }
    else if (type == CMARK_NODE_IMAGE || (type == CMARK_NODE_LINK && !leadsOut(cmark_node_get_url(node))))
    {
      unwrap(node);
    }
  }
}

/// Decimals that keep so many digits of a value.
int decimalsOf(double value, int digits)
{
  if (value == 0)
    return 0;
  return digits - 1 - static_cast<int>(std::floor(std::log10(std::abs(value))));
}

std::string fixedText(double value, int decimals)
{
  if (decimals < 0)
  {
    const double unit = std::pow(10.0, -decimals);
    value = std::round(value / unit) * unit;
  }
  std::string text = fmt::format("{:.{}f}", value, std::max(0, decimals));
  if (text.find_first_not_of("-0.") == std::string::npos && text.starts_with("-"))
    text.erase(0, 1); // minus nothing
  return withSign(text);
}

/// Too large or too small to be read without a power of ten.
bool wantsPower(double value)
{
  return value != 0 && (std::abs(value) >= 1e7 || std::abs(value) < 1e-4);
}

} // namespace

std::string escaped(std::string_view text)
{
  std::string result;
  result.reserve(text.size());
  while (!text.empty())
  {
    const std::size_t length = sequence(text);
    const char c = text.front();
    const bool control = (c >= 0 && c < 32 && c != '\n' && c != '\t' && c != '\r') || c == 127;
    if (length == 0 || control)
    {
      result += "\xef\xbf\xbd";
      text.remove_prefix(1);
      continue;
    }
    switch (c)
    {
      case '&':
        result += "&amp;";
        break;
      case '<':
        result += "&lt;";
        break;
      case '>':
        result += "&gt;";
        break;
      case '"':
        result += "&quot;";
        break;
      case '\'':
        result += "&#39;";
        break;
      default:
        result += text.substr(0, length);
    }
    text.remove_prefix(length);
  }
  return result;
}

std::string markdown(std::string_view text)
{
  const Node document(cmark_parse_document(text.data(), text.size(), CMARK_OPT_VALIDATE_UTF8), cmark_node_free);
  tame(document.get());
  const std::unique_ptr<char, decltype(&std::free)> html(
    cmark_render_html(document.get(), CMARK_OPT_DEFAULT), std::free);
  return html.get();
}

std::string literal(const std::string& text)
{
  return "`" + text + "`";
}

std::string markdownLine(std::string_view text)
{
  std::string html = markdown(text);
  while (html.ends_with("\n"))
    html.pop_back();
  if (html.starts_with("<p>") && html.ends_with("</p>") && html.find("<p>", 1) == std::string::npos)
    html = html.substr(3, html.size() - 7);
  return html;
}

std::string withSign(std::string text)
{
  if (text.starts_with("-"))
    text.replace(0, 1, "−");
  return text;
}

std::string base64(std::span<const std::byte> bytes)
{
  std::string text((bytes.size() + 2) / 3 * 4, '\0');
  const unsigned long length = vtkBase64Utilities::Encode(
    reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size(), reinterpret_cast<unsigned char*>(text.data()));
  text.resize(length);
  return text;
}

std::string numberHtml(double value, const Rounding& rounding)
{
  if (!std::isfinite(value))
    return "–";
  if (rounding.decimals)
    return fixedText(value, *rounding.decimals);
  const int digits = rounding.digits.value_or(usualDigits);
  const std::string rounded = fmt::format("{:.{}e}", value, digits - 1); // once: 9.9996 to four digits is 10.00
  if (wantsPower(value))
  {
    const std::size_t e = rounded.find('e');
    const std::string factor = rounded.substr(0, e);
    return fmt::format("{} × 10<sup>{}</sup>",
      withSign(rounding.digits ? factor : fmt::format("{}", std::stod(factor))),
      withSign(std::to_string(std::stoi(rounded.substr(e + 1)))));
  }
  if (value == std::round(value))
    return fixedText(value, 0); // a count, in full
  const double shown = std::stod(rounded);
  if (!rounding.digits && shown == value)
    return writtenHtml(value); // 0.25 has no more digits
  return fixedText(shown, decimalsOf(shown, digits));
}

std::string writtenHtml(double value)
{
  return wantsPower(value) || !std::isfinite(value) ? numberHtml(value) : withSign(fmt::format("{}", value));
}

std::string numberHtml(double value, double error, const Rounding& rounding)
{
  if (!std::isfinite(value) || !std::isfinite(error) || std::abs(error) <= roundOff * std::abs(value))
    return numberHtml(value, rounding);
  const int digits = rounding.digits.value_or(usualDigits);
  if (!rounding.decimals && wantsPower(value))
  {
    const int power = static_cast<int>(std::floor(std::log10(std::abs(value))));
    const double unit = std::pow(10.0, power);
    const Rounding inner{ {}, digits - 1 };
    return fmt::format("({} ± {}) × 10<sup>{}</sup>", numberHtml(value / unit, inner), numberHtml(error / unit, inner),
      withSign(std::to_string(power)));
  }
  const int decimals = rounding.decimals.value_or(std::max(0, decimalsOf(value, digits)));
  return fixedText(value, decimals) + " ± " + fixedText(error, decimals);
}

std::string timeText(double seconds)
{
  if (!std::isfinite(seconds) || seconds < 0)
    return "–";
  if (seconds < 99.95)
    return fmt::format("{:.{}f} s", seconds, seconds < 9.95 ? 1 : 0);
  const auto whole = static_cast<std::int64_t>(std::llround(seconds));
  return whole < 3600 ? fmt::format("{} min {} s", whole / 60, whole % 60)
                      : fmt::format("{} h {} min", whole / 3600, whole % 3600 / 60);
}

std::string page(std::string_view title, std::string_view body)
{
  return fmt::format("<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
                     "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n"
                     "<meta name=\"color-scheme\" content=\"light dark\">\n<title>{}</title>\n<style>\n{}</style>\n"
                     "</head>\n<body>\n<main>\n{}</main>\n</body>\n</html>\n",
    escaped(title), style, body);
}

} // namespace lamella::reports
