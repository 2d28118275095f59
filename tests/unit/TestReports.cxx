// Pages of results: what gets into them, and how numbers, curves and plans are read.
#include "TemporaryFolder.h"
#include "reports/Chart.h"
#include "reports/DataTable.h"
#include "reports/Html.h"
#include "reports/Page.h"
#include "reports/Plan.h"
#include "reports/Samples.h"

#include "core/Error.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstddef>
#include <fstream>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace
{

using namespace lamella::reports;

void write(const std::filesystem::path& path, const std::string& text)
{
  std::ofstream(path, std::ios::binary) << text;
}

/// What a plan is refused for.
std::string refusal(const std::string& json)
{
  const lamella::testing::TemporaryFolder folder;
  write(folder.path() / "report.json", json);
  try
  {
    static_cast<void>(readPlan(folder.path() / "report.json"));
  }
  catch (const lamella::InputError& error)
  {
    return std::string(error.what()) + " | " + error.hint();
  }
  return "";
}

bool holds(const std::string& text, const std::string& part)
{
  return text.find(part) != std::string::npos;
}

/// How often a text holds a part.
std::size_t count(const std::string& text, const std::string& part)
{
  std::size_t found = 0;
  for (std::size_t at = text.find(part); at != std::string::npos; at = text.find(part, at + 1))
    ++found;
  return found;
}

TEST(ReportText, NothingGetsThroughAsMarkup)
{
  EXPECT_EQ(escaped("<b a='1' c=\"2\">&amp;"), "&lt;b a=&#39;1&#39; c=&quot;2&quot;&gt;&amp;amp;");
  EXPECT_EQ(escaped("αβ ≥ 1 µm 𝛿"), "αβ ≥ 1 µm 𝛿");
  const std::string broken("a\xff\xc0\x80\xed\xa0\x80\x00z", 9); // no UTF-8, overlong, a surrogate, a zero
  EXPECT_EQ(escaped(broken), "a\uFFFD\uFFFD\uFFFD\uFFFD\uFFFD\uFFFD\uFFFDz");
  EXPECT_EQ(escaped("\xe2\x82"), "\uFFFD\uFFFD") << "cut short";
}

TEST(ReportText, MarkdownWithoutTagsPicturesAndForeignLinks)
{
  EXPECT_EQ(markdownLine("**E** of `a<b`"), "<strong>E</strong> of <code>a&lt;b</code>");
  EXPECT_EQ(markdownLine("2 < 3 <script>alert(1)</script>"), "2 &lt; 3 &lt;script&gt;alert(1)&lt;/script&gt;");
  EXPECT_EQ(markdown("<div onclick=\"x\">\n"), "<p>&lt;div onclick=&quot;x&quot;&gt;\n</p>\n");
  EXPECT_EQ(markdownLine("![a picture](x.png) and [there](../README.md)"), "a picture and there");
  EXPECT_EQ(markdownLine("[doi](https://doi.org/1)"), "<a href=\"https://doi.org/1\">doi</a>");
  EXPECT_FALSE(holds(markdown("[x](javascript:alert(1)) [y](data:text/html,z) [z](//host/a)"), "<a"));
}

TEST(ReportText, Base64)
{
  const auto of = [](const std::string& text) { return base64(std::as_bytes(std::span(text))); };
  EXPECT_EQ(of(""), ""); // RFC 4648, section 10
  EXPECT_EQ(of("f"), "Zg==");
  EXPECT_EQ(of("fo"), "Zm8=");
  EXPECT_EQ(of("foobar"), "Zm9vYmFy");
}

TEST(ReportText, NumbersAreRoundedOnce)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(numberHtml(0.279123), "0.2791");
  EXPECT_EQ(numberHtml(9.99996), "10.00");
  EXPECT_EQ(numberHtml(-1.5), "−1.5") << "no more digits than it has";
  EXPECT_EQ(numberHtml(-1.5, { 4, {} }), "−1.500");
  EXPECT_EQ(numberHtml(216494), "216494");
  EXPECT_EQ(numberHtml(123456.7), "123500");
  EXPECT_EQ(numberHtml(2.34567e-7), "2.346 × 10<sup>−7</sup>");
  EXPECT_EQ(numberHtml(-1e9), "−1 × 10<sup>9</sup>");
  EXPECT_EQ(numberHtml(0.0004, { {}, 2 }), "0.00");
  EXPECT_EQ(numberHtml(-0.0004, { {}, 2 }), "0.00") << "no minus nothing";
  EXPECT_EQ(numberHtml(nan), "–");
  EXPECT_EQ(numberHtml(0.279, 0.0517, { {}, 3 }), "0.279 ± 0.052");
  EXPECT_EQ(numberHtml(0.279, nan, { {}, 3 }), "0.279");
  EXPECT_EQ(numberHtml(0.279, 0, { {}, 4 }), "0.2790");
  EXPECT_EQ(numberHtml(0.35, 5e-17, {}), "0.35") << "round-off";
  EXPECT_EQ(numberHtml(2e9, 1e8, { 2, {} }), "(2.0 ± 0.1) × 10<sup>9</sup>");
  EXPECT_EQ(writtenHtml(0.123456789), "0.123456789");
  EXPECT_EQ(timeText(7.04), "7.0 s");
  EXPECT_EQ(timeText(99.96), "1 min 40 s");
  EXPECT_EQ(timeText(7500), "2 h 5 min");
  EXPECT_EQ(timeText(-1), "–");
}

TEST(ReportChart, TicksAreRoundAndInside)
{
  EXPECT_EQ(linearTicks(0, 1, 5), (std::vector<double>{ 0, 0.2, 0.4, 0.6000000000000001, 0.8, 1 }));
  for (const auto& [low, high] : { std::pair{ -3.7, 12.1 }, { 1e-12, 1.1e-12 }, { 5e8, 5.0001e8 }, { -2e-3, -1e-3 } })
  {
    const std::vector<double> ticks = linearTicks(low, high, 6);
    EXPECT_GE(ticks.size(), 3U);
    EXPECT_LE(ticks.size(), 13U);
    const double rim = 1e-6 * (high - low);
    EXPECT_GE(ticks.front(), low - rim);
    EXPECT_LE(ticks.back(), high + rim);
  }
  const std::vector<double> decades = logTicks(1e-3, 1e3);
  ASSERT_EQ(decades.size(), 7U);
  EXPECT_NEAR(decades[2], 0.1, 1e-15);        // powers by pow(), to round-off
  EXPECT_EQ(logTicks(1, 20).size(), 5U);      // 1, 2, 5, 10, 20
  EXPECT_EQ(logTicks(1.2e6, 4e6).size(), 4U); // 1.5, 2, 3 and 4 of a million
}

TEST(ReportChart, ThinningKeepsThePeaks)
{
  Curve curve;
  for (int i = 0; i < 100000; ++i)
  {
    curve.x.push_back(i);
    curve.y.push_back(i == 31415 ? 7 : i == 92653 ? -7 : std::sin(1e-3 * i));
  }
  const Curve thin = thinned(curve, 100);
  EXPECT_LE(thin.x.size(), 400U);
  EXPECT_EQ(*std::max_element(thin.y.begin(), thin.y.end()), 7);
  EXPECT_EQ(*std::min_element(thin.y.begin(), thin.y.end()), -7);
  EXPECT_EQ(thin.x.front(), 0);
  EXPECT_EQ(thin.x.back(), 99999);
  EXPECT_TRUE(std::is_sorted(thin.x.begin(), thin.x.end()));
}

TEST(ReportChart, DrawsWhatCanBeDrawn)
{
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Chart chart{ "x <1>", "y & z", false, false, true, "words", { { "a\"b", { 0, 1, 2, 3 }, { 1, nan, 2, 3 }, {} } },
    {} };
  const std::string drawn = svg(chart);
  EXPECT_TRUE(holds(drawn, "x &lt;1&gt;") && holds(drawn, "y &amp; z") && holds(drawn, "a&quot;b"));
  EXPECT_FALSE(holds(drawn, "nan"));
  EXPECT_FALSE(holds(drawn, "inf"));
  EXPECT_EQ(count(drawn, "<circle"), 3U);
  chart.curves.front().y = { nan, nan, nan, nan };
  EXPECT_EQ(svg(chart), "");
  chart.curves.front().y = { -1, -2, 0, -3 };
  chart.logY = true;
  EXPECT_EQ(svg(chart), "") << "nothing above 0";
  for (const double value : { 0.0, 5.0, -1e-300, 1e300 }) // one value alone is in the middle of its axis
  {
    const std::string level =
      svg({ "x", "y", false, false, true, "", { { "", { value, value }, { value, value }, {} } }, {} });
    EXPECT_TRUE(holds(level, "<circle")) << value;
    EXPECT_FALSE(holds(level, "nan") || holds(level, "inf")) << value;
  }
}

TEST(ReportChart, NumbersAlongAxesAreShort)
{
  EXPECT_EQ(numberText(0.30000000000000004), "0.3");
  EXPECT_EQ(numberText(8e7), "8 × 10⁷");
  EXPECT_EQ(numberText(-1e-9), "−1 × 10⁻⁹");
  const auto drawn = [](const std::string& label, double scale)
  {
    return svg(
      { "x", label, false, false, true, "", { { "", { 0, 1, 2 }, { scale, 2 * scale, 4 * scale }, {} } }, {} });
  };
  EXPECT_TRUE(holds(drawn("stress [Pa]", 1e6), ">stress [MPa]<"));
  EXPECT_TRUE(holds(drawn("stiffness [N/m]", 1e6), ">stiffness [10⁶ N/m]<"));
  EXPECT_TRUE(holds(drawn("strain", 1e-3), ">strain [10⁻³]<"));
  EXPECT_TRUE(holds(drawn("strain", 1e-3), ">4<"));
  EXPECT_TRUE(holds(drawn("share", 0.2), ">share<"));
  EXPECT_TRUE(holds(drawn(std::string(200, 'a') + "end", 1), "end<")) << "of a long name the end";
  EXPECT_FALSE(holds(drawn(std::string(200, 'a'), 1), std::string(60, 'a')));
}

TEST(ReportChart, WordsAlongXGetMarksWithBarsAndNoLines)
{
  Chart chart{ "law", "strength", false, false, false, "",
    { { "a", { 0, 1, 2 }, { 1, 2, 3 }, { 0.1, 0.2, 0.3 } }, { "b", { 0, 2 }, { 2, 4 }, {} } },
    { "one <1>", "two", "three" } };
  const std::string drawn = svg(chart);
  EXPECT_TRUE(holds(drawn, ">one &lt;1&gt;<") && holds(drawn, ">three<"));
  EXPECT_FALSE(holds(drawn, "stroke-linejoin"));
  EXPECT_EQ(count(drawn, "<circle"), 5U + 2U) << "and two beside the names";
  EXPECT_FALSE(holds(drawn, "rotate(-35)"));
  chart.kinds.assign(40, "a word that is rather long for its place");
  chart.kinds.back() = "last";
  EXPECT_TRUE(holds(svg(chart), "rotate(-35)"));
  EXPECT_LE(count(svg(chart), "rotate(-35)"), 28U) << "no more than there is room for";
}

TEST(ReportChart, ManyPointsWithBarsStayShort)
{
  Chart chart{ "x", "y", false, false, false, "", {}, {} };
  for (int k = 0; k < 8; ++k)
  {
    Curve curve{ "c" + std::to_string(k), {}, {}, {} };
    for (int i = 0; i < 20000; ++i)
    {
      curve.x.push_back(i);
      curve.y.push_back(std::sin(1e-3 * i) + k);
      curve.error.push_back(0.1);
    }
    chart.curves.push_back(curve);
  }
  EXPECT_LT(svg(chart).size(), 200'000U); // 2400 points of a path at 13 bytes, 200 bars at 90
  EXPECT_EQ(thinned(chart.curves.front(), 60).error.size(), thinned(chart.curves.front(), 60).x.size());
}

TEST(ReportTable, CellsUnitsAndRows)
{
  const lamella::testing::TemporaryFolder folder;
  write(folder.path() / "t.csv", "width,name,stress,gap\r\n0.25,\"a, b\",1e9,\r\n1.0,filled,2e9,nan\r\n");
  write(folder.path() / "t.csv.json", R"({"columns": {"stress": {"unit": "Pa"}, "gap": {"unit": "1"}}})");
  const DataTable table(folder.path() / "t.csv");
  EXPECT_EQ(table.rows(), 2U);
  EXPECT_EQ(table.text(0, table.column("name")), "a, b");
  EXPECT_EQ(table.number(1, table.column("stress")), 2e9);
  EXPECT_TRUE(std::isnan(table.number(0, table.column("gap"))));
  EXPECT_TRUE(table.isNumeric(table.column("width")));
  EXPECT_FALSE(table.isNumeric(table.column("name")));
  EXPECT_EQ(table.unit("stress"), "Pa");
  EXPECT_EQ(table.unit("gap"), "") << "a number without a unit";
  EXPECT_EQ(table.row({ { "width", "1" } }), 1U) << "1 and 1.0 are one number";
  EXPECT_EQ(table.row({ { "name", "filled" } }), 1U);
  EXPECT_THROW(static_cast<void>(table.row({})), lamella::InputError) << "two rows";
  EXPECT_THROW(static_cast<void>(table.row({ { "width", "3" } })), lamella::InputError);
  EXPECT_THROW(static_cast<void>(table.column("strain")), lamella::InputError);
}

TEST(ReportSamples, KeysRepeatsAndWhichAreShown)
{
  const lamella::testing::TemporaryFolder folder;
  std::string rows = "sample,material.young.wall,sample.seed,fracture.law,status,strength,end\n";
  for (int i = 0; i < 12; ++i)
    rows += "k" + std::to_string(i) + (i < 6 ? ",1e9," : ",2e9,") + std::to_string(i % 3) +
      (i % 6 < 3 ? ",\"a, b\"" : ",c") + (i == 4 ? ",failed,,\n" : ",done,1,fell\n");
  write(folder.path() / "table.csv", rows);
  write(folder.path() / "table.csv.json", R"({"columns": {"material.young.wall": {"unit": "Pa"}}})");
  const Samples samples(folder.path());
  ASSERT_EQ(samples.keys().size(), 3U);
  EXPECT_EQ(samples.caption(3), "young.wall 10⁹ Pa, seed 0, law c");
  EXPECT_TRUE(samples.keys()[1].averaged) << "a seed, where settings.csv does not say";
  EXPECT_EQ(samples.measures().size(), 1U) << "numbers alone";
  EXPECT_TRUE(samples.failed(4));
  EXPECT_EQ(samples.some(100).size(), 12U);
  EXPECT_EQ(samples.some(9), (std::vector<std::size_t>{ 0, 1, 3, 4, 6, 7, 9, 10 })) << "two of each setting";
  EXPECT_EQ(samples.some(3), (std::vector<std::size_t>{ 0, 3, 6 })) << "of some settings";
  EXPECT_THROW(Samples(folder.path() / "none"), lamella::InputError);
}

TEST(ReportPlan, SaysWhereItIsWrong)
{
  EXPECT_EQ(refusal("{}"), "");
  EXPECT_TRUE(holds(refusal("{\n \"title\": }"), "line 2"));
  EXPECT_TRUE(holds(refusal("[]"), "the file is no object"));
  EXPECT_TRUE(holds(refusal(R"({"titel": "x"})"), "titel is not known | did you mean 'title'?"));
  EXPECT_TRUE(holds(refusal(R"({"title": 3})"), "title is no text"));
  EXPECT_TRUE(holds(refusal(R"({"title": 1e999})"), "is no JSON: number overflow parsing '1e999' | docs/commands"));
  EXPECT_TRUE(holds(refusal(R"({"sections": {}})"), "sections is no list"));
  EXPECT_TRUE(holds(refusal(R"({"sections": [{"title": "a", "figures": [{"file": "x.png", "captoin": ""}]}]})"),
    "sections[0].figures[0].captoin is not known | did you mean 'caption'?"));
  const auto figure = [](const std::string& file)
  { return refusal(R"({"sections": [{"title": "a", "figures": [{"file": ")" + file + R"("}]}]})"); };
  EXPECT_EQ(figure("a/../b.png"), "");
  EXPECT_TRUE(holds(figure("../b.png"), "lies outside the folder"));
  EXPECT_TRUE(holds(figure("a/../../b.png"), "lies outside the folder"));
  EXPECT_TRUE(holds(figure("/etc/passwd"), "lies outside the folder"));
  EXPECT_TRUE(
    holds(refusal(R"({"sections": [{"title": "a", "curves": [{"file": "a.csv", "x": "x"}]}]})"), "y is missing"));
  EXPECT_TRUE(holds(refusal(R"({"sections": [{"title": "a", "tables": [{"file": "a.csv", "rows": 0.5}]}]})"),
    "sections[0].tables[0].rows is no whole number"));
  EXPECT_TRUE(holds(refusal(R"({"sections": [{"title": "1", "sections": [{"title": "2", "sections": [{"title": "3",
    "sections": [{"title": "4"}]}]}]}]})"),
    "goes too deep"));
}

TEST(ReportPage, ComparesWithTheTablesOfTheFolder)
{
  const lamella::testing::TemporaryFolder folder;
  write(folder.path() / "means.csv", "width,strength,deviation\n0.5,0.2,0.01\n1.0,0.285,0.05\n");
  write(folder.path() / "report.json", R"({"title": "A <b>", "sections": [{"title": "s", "comparison": [
    {"what": "strength", "paper": 0.38, "ours": {"file": "means.csv", "column": "strength", "error": "deviation",
      "where": {"width": 1}}, "decimals": 3, "unit": "MPa", "why": "**so**"},
    {"what": "in words", "paper": "above 1", "ours": 1.5},
    {"what": "not there", "paper": 1, "ours": {"file": "means.csv", "column": "strength", "where": {"width": 7}}}]}]})");
  const PageOfResults page = pageOf(folder.path(), folder.path() / "page.html", {});
  EXPECT_TRUE(holds(page.html, "<title>A &lt;b&gt;</title>"));
  EXPECT_TRUE(holds(page.html,
    "<tr><td>strength</td><td class=\"v\">0.38 MPa</td><td class=\"v\">0.285 ± 0.050 MPa</td><td>−25 %</td><td "
    "class=\"wide\"><strong>so</strong>"));
  EXPECT_TRUE(holds(page.html, "<td>above 1</td><td class=\"v\">1.5</td><td></td>"));
  ASSERT_EQ(page.problems.size(), 1U);
  EXPECT_TRUE(holds(page.problems.front(), "no row with width = 7"));
  EXPECT_TRUE(holds(page.html, "Missing or damaged"));
}

} // namespace
