#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>

/// Text as HTML. Nothing that comes from a file gets into a page but through these.
namespace lamella::reports
{

/// The text as it is: & < > " and ' as entities, control characters and bytes that are no UTF-8 as U+FFFD.
[[nodiscard]] std::string escaped(std::string_view text);

/// CommonMark as HTML. Tags in the text are shown as text, pictures by their words; links other than to the web
/// (http, https) and within the page (#...) are shown as text, since they would lead nowhere from a page that was
/// moved.
[[nodiscard]] std::string markdown(std::string_view text);

/// Markdown that shows a text as it is, as code.
[[nodiscard]] std::string literal(const std::string& text);

/// markdown() of a single line: without a paragraph around it.
[[nodiscard]] std::string markdownLine(std::string_view text);

/// A number's text with a minus sign in place of a hyphen.
[[nodiscard]] std::string withSign(std::string text);

[[nodiscard]] std::string base64(std::span<const std::byte> bytes);

/// How a number is rounded: to decimals, else to significant digits, else to four of these at most.
struct Rounding
{
  std::optional<int> digits = {};
  std::optional<int> decimals = {};
};
inline constexpr int usualDigits = 4;
inline constexpr double roundOff = 1e-12; ///< numbers no farther apart are the same, relative

/// A number as HTML: 0.279, −1.5, 2.3 × 10<sup>−7</sup>; "–" for one that is not finite.
[[nodiscard]] std::string numberHtml(double value, const Rounding& rounding = {});

/// A number as somebody wrote it down: with all of its digits and no more.
[[nodiscard]] std::string writtenHtml(double value);

/// "value ± error", both to the same decimals; an error that is 0, to round-off, or not finite is left out.
[[nodiscard]] std::string numberHtml(double value, double error, const Rounding& rounding = {});

/// "12 s", "3 min 20 s", "2 h 5 min".
[[nodiscard]] std::string timeText(double seconds);

/// A whole page.
/// @param title plain text; `body` HTML
[[nodiscard]] std::string page(std::string_view title, std::string_view body);

} // namespace lamella::reports
