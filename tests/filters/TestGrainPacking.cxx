// Packings and bridges through the pipeline: what the numerics give, under the names that the data model tells.
#include "PackingData.h"
#include "VtkTesting.h"
#include "vtkGrainPacking.h"
#include "vtkMatrixBridges.h"
#include "vtkPackingReader.h"
#include "vtkSampleAlgorithm.h"

#include "core/Error.h"
#include "packing/Packing.h"

#include "vtkCellArray.h"
#include "vtkCellData.h"
#include "vtkPolyData.h"
#include "vtkXMLPolyDataWriter.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <fstream>

namespace
{

using namespace lamella;

packing::PackingOptions smallOptions(int dimension)
{
  packing::PackingOptions options;
  options.dimension = dimension;
  options.count = dimension == 3 ? 40 : 80;
  options.aspect = dimension == 3 ? 1 : 2;
  options.softness = 1e-4;
  options.seed = 5;
  return options;
}

void set(vtkGrainPacking* source, const packing::PackingOptions& options)
{
  source->SetDimension(options.dimension);
  source->SetCount(options.count);
  source->SetAspect(options.aspect);
  source->SetSoftness(options.softness);
  source->SetSeed(static_cast<vtkIdType>(options.seed));
}

double at(vtkPolyData* data, const char* name, vtkIdType i)
{
  return data->GetPointData()->GetArray(name)->GetTuple1(i);
}

class GrainPacking : public ::testing::TestWithParam<int>
{
};

TEST_P(GrainPacking, IsThatOfTheLibrary)
{
  const packing::PackingOptions options = smallOptions(GetParam());
  const packing::Packing expected = packing::pack(options);
  const packing::PackingStatistics numbers = packing::statistics(expected);
  vtkNew<vtkGrainPacking> source;
  set(source, options);
  ASSERT_EQ(vtktest::errorOf(source), "");
  vtkPolyData* const grains = source->GetOutput();
  ASSERT_EQ(grains->GetNumberOfPoints(), options.count);
  EXPECT_EQ(grains->GetNumberOfVerts(), options.count);
  std::vector<int> number(expected.count(), 0);
  for (const packing::Contact& contact : expected.contacts)
  {
    ++number[static_cast<std::size_t>(contact.first)];
    if (contact.second >= 0)
      ++number[static_cast<std::size_t>(contact.second)];
  }
  for (std::size_t i = 0; i < expected.count(); ++i)
  {
    const auto id = static_cast<vtkIdType>(i);
    for (int axis = 0; axis < 3; ++axis)
      ASSERT_EQ(grains->GetPoint(id)[axis], expected.centre[i][static_cast<std::size_t>(axis)]);
    ASSERT_EQ(at(grains, "radius", id), expected.radius[i]);
    ASSERT_EQ(at(grains, "diameter", id), 2 * expected.radius[i]);
    ASSERT_EQ(at(grains, "grain", id), static_cast<double>(i + 1));
    ASSERT_EQ(at(grains, "contacts", id), number[i]);
    ASSERT_EQ(at(grains, "rattler", id), numbers.rattler[i]);
  }
  EXPECT_EQ(fieldNumbers(grains, "packing_fraction").at(0), numbers.packingFraction);
  EXPECT_EQ(fieldNumbers(grains, "coordination").at(0), numbers.coordination);
  EXPECT_EQ(fieldNumbers(grains, "seed").at(0), 5);
  EXPECT_EQ(fieldNumbers(grains, "box").at(1), expected.size[1]);
  EXPECT_EQ(fieldNumbers(grains, "stress").size(), 9U);
  EXPECT_NE(provenance(grains).find("\"packing\""), std::string::npos);
}

TEST_P(GrainPacking, ContactsAreLinesWithForces)
{
  vtkNew<vtkGrainPacking> source;
  set(source, smallOptions(GetParam()));
  ASSERT_EQ(vtktest::errorOf(source), "");
  vtkPolyData* const grains = source->GetOutput();
  vtkPolyData* const contacts = source->GetContacts();
  vtkCellData* const cells = contacts->GetCellData();
  ASSERT_GT(contacts->GetNumberOfLines(), grains->GetNumberOfPoints());
  // The forces on each grain balance: the library's tolerance is 1e-4 of the mean contact force, and a grain feels
  // at most a few contacts.
  std::vector<std::array<double, 3>> net(static_cast<std::size_t>(grains->GetNumberOfPoints()), { 0, 0, 0 });
  double mean = 0;
  for (vtkIdType i = 0; i < contacts->GetNumberOfLines(); ++i)
  {
    const int first = static_cast<int>(cells->GetArray("first")->GetTuple1(i));
    const int second = static_cast<int>(cells->GetArray("second")->GetTuple1(i));
    ASSERT_GE(first, 1);
    ASSERT_EQ(second < 0, cells->GetArray("wall")->GetTuple1(i) == 1);
    const double* const force = cells->GetArray("force")->GetTuple3(i);
    for (std::size_t axis = 0; axis < 3; ++axis)
    {
      net[static_cast<std::size_t>(first - 1)][axis] -= force[axis];
      if (second > 0)
        net[static_cast<std::size_t>(second - 1)][axis] += force[axis];
    }
    const double normal = cells->GetArray("normal_force")->GetTuple1(i);
    EXPECT_GT(normal, 0); // pressed
    EXPECT_EQ(contacts->GetPointData()->GetArray("normal_force")->GetTuple1(2 * i), normal);
    mean += normal / static_cast<double>(contacts->GetNumberOfLines());
    // The line begins at the first grain's centre.
    for (int axis = 0; axis < 3; ++axis)
      ASSERT_EQ(contacts->GetPoint(2 * i)[axis], grains->GetPoint(first - 1)[axis]);
  }
  for (const std::array<double, 3>& sum : net)
    EXPECT_LT(std::hypot(sum[0], sum[1], sum[2]), 0.01 * mean);
  const auto [unit, text, creator] = description(cells->GetArray("force"));
  EXPECT_EQ(unit, GetParam() == 3 ? "N" : "N/m");
  EXPECT_EQ(creator, "vtkGrainPacking");
}

TEST_P(GrainPacking, TablesComeBackAsTheyWere)
{
  vtkNew<vtkGrainPacking> source;
  set(source, smallOptions(GetParam()));
  ASSERT_EQ(vtktest::errorOf(source), "");
  const packing::Packing made = packingFrom(source->GetOutput());
  const bool spheres = GetParam() == 3;
  const std::string name = "grains" + std::to_string(GetParam()) + ".csv";
  std::ofstream file(name);
  file << (spheres ? "id;Radius (mm);x;y;z\n" : "id;Radius (mm);x;z\n");
  file.precision(17);
  for (std::size_t i = 0; i < made.count(); ++i)
  {
    file << i << ";" << 1e3 * made.radius[i] << ";" << 1e3 * made.centre[i][0] << ";" << 1e3 * made.centre[i][1];
    file << (spheres ? ";" + std::to_string(1e3 * made.centre[i][2]) : "") << "\n";
  }
  file.close();
  vtkNew<vtkPackingReader> reader;
  reader->SetFileName(name.c_str());
  reader->SetLengthUnit(1e-3);
  reader->SetBoxSize(made.size.data());
  ASSERT_EQ(vtktest::errorOf(reader), "");
  const packing::Packing read = packingFrom(reader->GetOutput());
  EXPECT_EQ(read.dimension, GetParam());
  ASSERT_EQ(read.count(), made.count());
  for (std::size_t i = 0; i < made.count(); ++i)
  {
    EXPECT_NEAR(read.radius[i], made.radius[i], 1e-15);
    EXPECT_NEAR(read.centre[i][0], made.centre[i][0], 1e-15);
    EXPECT_NEAR(read.centre[i][1], made.centre[i][1], 1e-15);
    EXPECT_NEAR(read.centre[i][2], made.centre[i][2], 1e-9); // six decimals of a millimetre
  }
  EXPECT_GT(reader->GetContacts()->GetNumberOfLines(), 0);
  EXPECT_NE(provenance(reader->GetOutput()).find("sha256"), std::string::npos);
  std::remove(name.c_str());
}

TEST_P(GrainPacking, CementIsThatOfTheLibrary)
{
  vtkNew<vtkGrainPacking> source;
  set(source, smallOptions(GetParam()));
  vtkNew<vtkMatrixBridges> bridges;
  bridges->SetInputConnection(source->GetOutputPort());
  bridges->SetNodesAcross(GetParam() == 3 ? 24 : 60);
  bridges->SetWidth(0.6);
  bridges->SetPlaten(4e-4);
  ASSERT_EQ(vtktest::errorOf(bridges), "");
  vtkImageData* const image = bridges->GetOutput();
  packing::BridgeOptions options;
  options.width = 0.6;
  const packing::CementedSample expected =
    packing::cement(packingFrom(source->GetOutput()), options, { GetParam() == 3 ? 24 : 60, 4e-4 });
  const PhaseView view = viewPhases(image);
  EXPECT_EQ(view.lattice.size, expected.image.lattice.size);
  EXPECT_EQ(view.lattice.spacing, expected.image.lattice.spacing);
  EXPECT_EQ(view.phases.names(), (std::vector<std::string>{ "void", "matrix", "grain" }));
  EXPECT_TRUE(std::equal(view.phase.begin(), view.phase.end(), expected.image.phase.begin()));
  vtkDataArray* const grain = image->GetPointData()->GetArray("grain");
  for (std::size_t i = 0; i < expected.grain.size(); ++i)
    ASSERT_EQ(grain->GetTuple1(static_cast<vtkIdType>(i)), expected.grain[i]);
  EXPECT_EQ(fieldNumbers(image, "width").at(0), 0.6);
  EXPECT_EQ(fieldNumbers(image, "reach").at(0), 1.1);
  EXPECT_EQ(fieldNumbers(image, "bridges").at(0), static_cast<double>(expected.bridges));
  EXPECT_EQ(fieldNumbers(image, "saturation").at(0), expected.fractions.saturation);
  const double sum = fieldNumbers(image, "grain_fraction").at(0) + fieldNumbers(image, "matrix_fraction").at(0) +
    fieldNumbers(image, "void_fraction").at(0);
  EXPECT_NEAR(sum, 1, 1e-12);
  // The record tells the packing and the bridges.
  EXPECT_NE(provenance(image).find("\"packing\""), std::string::npos);
  EXPECT_NE(provenance(image).find("\"bridges\""), std::string::npos);
}

TEST_P(GrainPacking, CementConducts)
{
  vtkNew<vtkGrainPacking> source;
  set(source, smallOptions(GetParam()));
  vtkNew<vtkMatrixBridges> bridges;
  bridges->SetInputConnection(source->GetOutputPort());
  bridges->SetNodesAcross(GetParam() == 3 ? 16 : 40);
  vtkNew<vtkSteadyDiffusion> solver;
  solver->SetInputConnection(bridges->GetOutputPort());
  solver->SetConductivity("void", 0.01);
  solver->SetConductivity("matrix", 0.1);
  solver->SetConductivity("grain", 1);
  ASSERT_EQ(vtktest::errorOf(solver), "");
  EXPECT_GT(solver->GetEffectiveConductivity()[0], 0.01);
  EXPECT_LT(solver->GetEffectiveConductivity()[0], 1);
}

INSTANTIATE_TEST_SUITE_P(Dimensions, GrainPacking, ::testing::Values(2, 3),
  [](const auto& dimension) { return std::to_string(dimension.param) + "D"; });

TEST(GrainPackingDefaults, AreTheLibrarys)
{
  const packing::PackingOptions options;
  vtkNew<vtkGrainPacking> source;
  EXPECT_EQ(source->GetDimension(), options.dimension);
  EXPECT_EQ(source->GetCount(), options.count);
  EXPECT_EQ(source->GetMeanDiameter(), options.meanDiameter);
  EXPECT_EQ(source->GetDiameterRatio(), options.diameterRatio);
  EXPECT_EQ(source->GetSizes(), static_cast<int>(options.sizes));
  EXPECT_EQ(source->GetAspect(), options.aspect);
  EXPECT_EQ(source->GetPeriodic(), options.periodic);
  EXPECT_EQ(source->GetFriction(), options.friction);
  EXPECT_EQ(source->GetPressure(), options.pressure);
  EXPECT_EQ(source->GetSoftness(), options.softness);
  EXPECT_EQ(source->GetPackingFraction(), options.packingFraction.value_or(0));
  EXPECT_EQ(source->GetSeed(), static_cast<vtkIdType>(options.seed));
  EXPECT_EQ(source->GetTolerance(), options.tolerance);
  const packing::BridgeOptions cement;
  vtkNew<vtkMatrixBridges> bridges;
  EXPECT_EQ(bridges->GetWidth(), cement.width);
  EXPECT_EQ(bridges->GetReach(), cement.reach);
  EXPECT_EQ(bridges->GetFilled(), cement.filled);
  EXPECT_EQ(bridges->GetNodesAcross(), packing::RasterOptions().nodesAcross);
  EXPECT_EQ(bridges->GetPlaten(), packing::RasterOptions().platen);
}

TEST(GrainPackingLoose, StopsWhereItIsTold)
{
  vtkNew<vtkGrainPacking> source;
  source->SetCount(60);
  source->SetPackingFraction(0.6);
  source->SetPeriodic(true);
  ASSERT_EQ(vtktest::errorOf(source), "");
  EXPECT_NEAR(fieldNumbers(source->GetOutput(), "packing_fraction").at(0), 0.6, 1e-9);
  EXPECT_EQ(fieldNumbers(source->GetOutput(), "periodic").at(0), 1);
  EXPECT_TRUE(packingFrom(source->GetOutput()).periodic[1]);
}

TEST(GrainPackingAbort, LeavesNothing)
{
  vtkNew<vtkGrainPacking> source;
  vtkNew<vtkCallbackCommand> stop;
  stop->SetCallback(
    [](vtkObject* caller, unsigned long, void*, void*) { static_cast<vtkAlgorithm*>(caller)->SetAbortExecute(1); });
  source->AddObserver(vtkCommand::ProgressEvent, stop);
  EXPECT_EQ(vtktest::errorOf(source), "");
  EXPECT_EQ(source->GetOutput()->GetNumberOfPoints(), 0);
}

struct Seen
{
  std::vector<double> steps;
  std::vector<double> unbalanced;
};

TEST(GrainPackingStates, AreToldOnTheWayAndChangeNothing)
{
  vtkNew<vtkGrainPacking> plain;
  set(plain, smallOptions(2));
  ASSERT_EQ(vtktest::errorOf(plain), "");
  EXPECT_EQ(plain->GetNumberOfStates(), 1); // the end
  vtkNew<vtkGrainPacking> source;
  set(source, smallOptions(2));
  source->SetStateEvery(100);
  Seen seen;
  vtkNew<vtkCallbackCommand> watch;
  watch->SetClientData(&seen);
  watch->SetCallback(
    [](vtkObject*, unsigned long, void* data, void* state)
    {
      auto* const grains = vtkPolyData::SafeDownCast(static_cast<vtkDataObject*>(state));
      auto* const all = static_cast<Seen*>(data);
      all->steps.push_back(fieldNumbers(grains, "relaxation_steps").at(0));
      // The arrays of each state are its own: the forces on the grains are what it says of them.
      vtkDataArray* const net = grains->GetPointData()->GetArray("net_force");
      vtkDataArray* const normal = grains->GetPointData()->GetArray("normal_force");
      double sum = 0;
      double pushes = 0;
      for (vtkIdType i = 0; i < grains->GetNumberOfPoints(); ++i)
      {
        sum += std::hypot(net->GetComponent(i, 0), net->GetComponent(i, 1));
        pushes += normal->GetTuple1(i);
      }
      all->unbalanced.push_back(pushes > 0 ? sum / pushes : 0);
    });
  source->AddObserver(vtkSampleAlgorithm::STEP_EVENT, watch);
  ASSERT_EQ(vtktest::errorOf(source), "");
  ASSERT_GT(source->GetNumberOfStates(), 5);
  EXPECT_EQ(seen.steps.size(), static_cast<std::size_t>(source->GetNumberOfStates()));
  EXPECT_EQ(seen.steps.front(), 0);
  EXPECT_TRUE(std::is_sorted(seen.steps.begin(), seen.steps.end()));
  EXPECT_GT(seen.unbalanced.front(), 0.1); // random places
  EXPECT_LT(seen.unbalanced.back(), 1e-4);
  EXPECT_EQ(source->GetStateRange()[1], source->GetNumberOfStates() - 1);
  for (vtkIdType i = 0; i < plain->GetOutput()->GetNumberOfPoints(); ++i)
    for (int axis = 0; axis < 3; ++axis)
      ASSERT_EQ(source->GetOutput()->GetPoint(i)[axis], plain->GetOutput()->GetPoint(i)[axis]);
  EXPECT_EQ(source->GetContacts()->GetNumberOfLines(), plain->GetContacts()->GetNumberOfLines());
  // Another state is shown without another run.
  source->SetState(0);
  source->Update();
  EXPECT_EQ(seen.steps.size(), static_cast<std::size_t>(source->GetNumberOfStates()));
  EXPECT_EQ(fieldNumbers(source->GetOutput(), "relaxation_steps").at(0), 0);
  EXPECT_EQ(source->GetContacts()->GetNumberOfLines(), source->GetStateContacts(0)->GetNumberOfLines());
  EXPECT_EQ(fieldText(source->GetOutput(), "stage").value(), "compressing");
  EXPECT_EQ(fieldText(plain->GetOutput(), "stage").value(), "at rest");
}

TEST(GrainPackingStates, OneAtATimeAndStoppedByWhoSeesThem)
{
  vtkNew<vtkGrainPacking> source;
  set(source, smallOptions(2));
  source->SetStateEvery(50);
  source->KeepStatesOff();
  ASSERT_EQ(vtktest::errorOf(source), "");
  EXPECT_EQ(source->GetNumberOfStates(), 1);
  int told = 0;
  vtkNew<vtkCallbackCommand> stop;
  stop->SetClientData(&told);
  stop->SetCallback(
    [](vtkObject* caller, unsigned long, void* count, void*)
    {
      if (++*static_cast<int*>(count) == 3)
        static_cast<vtkAlgorithm*>(caller)->SetAbortExecute(1);
    });
  source->AddObserver(vtkSampleAlgorithm::STEP_EVENT, stop);
  source->SetSeed(6);
  EXPECT_EQ(vtktest::errorOf(source), "");
  EXPECT_EQ(told, 3);
  EXPECT_EQ(source->GetOutput()->GetNumberOfPoints(), 0);
  EXPECT_EQ(source->GetNumberOfStates(), 0);
}

TEST(GrainPackingErrors, SayWhatIsWrong)
{
  vtkNew<vtkGrainPacking> source;
  source->SetCount(3);
  EXPECT_NE(vtktest::errorOf(source).find("3 grains"), std::string::npos);
  source->SetCount(60);
  source->SetSeed(-1);
  EXPECT_NE(vtktest::errorOf(source).find("seed -1 is below 0"), std::string::npos);
  source->SetSeed(1);
  source->SetPackingFraction(0.99);
  EXPECT_NE(vtktest::errorOf(source).find("hint: "), std::string::npos);
}

TEST(PackingReaderParticles, KeepWhatTheFileHolds)
{
  vtkNew<vtkGrainPacking> source;
  set(source, smallOptions(2));
  source->Update();
  vtkNew<vtkXMLPolyDataWriter> writer;
  writer->SetInputData(source->GetOutput());
  writer->SetFileName("particles.vtp");
  writer->SetDataModeToBinary();
  ASSERT_EQ(writer->Write(), 1);
  vtkNew<vtkPackingReader> reader;
  reader->SetFileName("particles.vtp");
  ASSERT_EQ(vtktest::errorOf(reader), "");
  EXPECT_EQ(fieldNumbers(reader->GetOutput(), "coordination"), fieldNumbers(source->GetOutput(), "coordination"));
  EXPECT_EQ(at(reader->GetOutput(), "contacts", 7), at(source->GetOutput(), "contacts", 7));
  EXPECT_EQ(reader->GetContacts()->GetNumberOfCells(), 0);
  std::remove("particles.vtp");
}

struct BadTable
{
  const char* name;
  const char* text;
  const char* message;
};

class PackingReaderErrors : public ::testing::TestWithParam<BadTable>
{
};

TEST_P(PackingReaderErrors, SayWhatIsWrong)
{
  const std::string name = std::string("bad_") + GetParam().name + ".csv";
  std::ofstream(name) << GetParam().text;
  vtkNew<vtkPackingReader> reader;
  reader->SetFileName(name.c_str());
  const std::string error = vtktest::errorOf(reader);
  EXPECT_NE(error.find(GetParam().message), std::string::npos) << error;
  EXPECT_NE(error.find("\nhint: "), std::string::npos) << error;
  EXPECT_EQ(reader->GetOutput()->GetNumberOfPoints(), 0);
  std::remove(name.c_str());
}

INSTANTIATE_TEST_SUITE_P(All, PackingReaderErrors,
  ::testing::Values(BadTable{ "empty", "", "is empty" }, BadTable{ "no_grains", "x,z,r\n", "there are no grains" },
    BadTable{ "no_names", "0.1,0.2,0.05\n0.3,0.2,0.05\n", "has no line of names: it begins with '0.1', '0.2'" },
    BadTable{ "no_radius", "x,z,mass\n0,0,1\n", "lacks the column r; separated by commas, it has 'x', 'z', 'mass'" },
    BadTable{ "one_axis", "x,r\n0,1\n", "lacks the column y or z" },
    BadTable{ "twice", "x,z,r,radius\n0,0,1,1\n", "has two columns for the same: 'r' and 'radius'" },
    BadTable{
      "two_sizes", "x,z,radius,diameter\n0,0,1,2\n3,0,1,1\n", "has a radius of 1 and a diameter of 1 in row 3" },
    BadTable{ "text", "x,z,r\n0,0,1\n0,five,1\n", "has the text 'five' where a number belongs, in row 3, column 'z'" },
    BadTable{ "gap", "x,z,r\n0,0,1\n0,,1\n", "has nothing in row 3, column 'z'" },
    BadTable{ "decimal_comma", "x;z;r\n0;0;1\n0,5;3;1\n", "has a decimal comma: '0,5' in row 3, column 'x'" },
    BadTable{ "negative", "x,z,r\n0,0,-1\n", "the radius of grain 1 is -1" },
    BadTable{ "overlap", "x,z,r\n0,0,1\n0.5,0,1\n", "grains 1 and 2 overlap" },
    BadTable{ "nan", "x,z,r\n0,nan,1\n", "the centre of grain 1 has the coordinate nan" }),
  [](const auto& bad) { return std::string(bad.param.name); });

TEST(PackingReaderTables, AcceptEverySeparator)
{
  for (const char* const text : { "x,z,r\n1,1,1\n3,1,1\n", "x;z;r\n1;1;1\n3;1;1\n", "x\tz\tr\n1\t1\t1\n3\t1\t1\n",
         "x  z   r\n1 1  1\n3 1 1\n", "# x, z, r\r\n1, 1, 1\r\n3, 1, 1\r\n", "z,d,X\n1,2,1\n1,2,3\n",
         "x,z,Radius [m],diameter\n1,1,1,2\n3,1,1,2.000001\n", "x,y,z,radius,diameter\n1,1,0,1,2\n3,1,0,1,2\n" })
  {
    std::ofstream("separated.csv") << text;
    vtkNew<vtkPackingReader> reader;
    reader->SetFileName("separated.csv");
    ASSERT_EQ(vtktest::errorOf(reader), "") << text;
    ASSERT_EQ(reader->GetOutput()->GetNumberOfPoints(), 2) << text;
    EXPECT_EQ(at(reader->GetOutput(), "radius", 1), 1) << text;
    EXPECT_EQ(reader->GetOutput()->GetPoint(1)[0], 3) << text;
    EXPECT_EQ(fieldNumbers(reader->GetOutput(), "box"), (std::vector<double>{ 4, 2, 0 })) << text;
  }
  std::remove("separated.csv");
}

TEST(PackingReaderFiles, AreNamed)
{
  vtkNew<vtkPackingReader> reader;
  EXPECT_NE(vtktest::errorOf(reader).find("no file is named"), std::string::npos);
  reader->SetFileName("nowhere.csv");
  EXPECT_NE(vtktest::errorOf(reader).find("there is no file 'nowhere.csv'"), std::string::npos);
  reader->SetFileName("nowhere.vtp");
  EXPECT_NE(vtktest::errorOf(reader).find("there is no file 'nowhere.vtp'"), std::string::npos);
  std::ofstream("outside.csv") << "x,z,r\n5,1,1\n";
  reader->SetFileName("outside.csv");
  reader->SetBoxSize(2, 2, 0);
  EXPECT_NE(vtktest::errorOf(reader).find("lies outside the box"), std::string::npos);
  std::remove("outside.csv");
}

TEST(MatrixBridgesErrors, SayWhatIsWrong)
{
  vtkNew<vtkPolyData> points;
  vtkNew<vtkMatrixBridges> bridges;
  bridges->SetInputData(points);
  EXPECT_NE(vtktest::errorOf(bridges).find("no array 'radius'"), std::string::npos);
  packing::Packing two =
    packing::packingOf(2, std::vector<std::array<double, 3>>{ { 1, 1, 0 }, { 3, 1, 0 } }, std::vector<double>{ 1, 1 });
  vtkNew<vtkPolyData> grains;
  setPacking(two, packing::statistics(two), "test", grains, nullptr);
  bridges->SetInputData(grains);
  bridges->SetReach(3);
  EXPECT_NE(vtktest::errorOf(bridges).find("reach 3 is above 2"), std::string::npos);
  bridges->SetReach(1.1);
  bridges->SetFilled(true);
  bridges->SetSaturation(0.5);
  EXPECT_NE(vtktest::errorOf(bridges).find("contradict each other"), std::string::npos);
  bridges->SetSaturation(0);
  EXPECT_EQ(vtktest::errorOf(bridges), "");
  EXPECT_EQ(fieldNumbers(bridges->GetOutput(), "saturation").at(0), 1);
}

} // namespace
