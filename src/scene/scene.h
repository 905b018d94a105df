#pragma once
// What is to be simulated, as plain data: made by scene/scene_file.h from YAML and URDF, validated there.
// SI units. World frame W: z up, the tank's floor at z = tank.origin.z() (REP-103).

#include <Eigen/Geometry>
#include <limits>
#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/shape.h"

namespace monolith {

// A scene that cannot be simulated. what() names file, element, value and what was expected; if several
// things are wrong it has a line for each.
class SceneError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

struct TankDescription {
  Eigen::Vector3d size = Eigen::Vector3d::Ones();     // m; a whole number of cells along each axis
  Eigen::Vector3d origin = Eigen::Vector3d::Zero();   // m; the corner with the least coordinates, in W
  double cell_width = 0.05;                           // m
  bool periodic[3] = {false, false, false};           // walls along an axis are replaced by periodicity
};

// How viscosity depends on the shear rate; laws and sources in fluid/rheology.h. Only the parameters of the law count.
struct RheologyDescription {
  enum class Law { kNewtonian, kPowerLaw, kCarreauYasuda, kHerschelBulkley };
  Law law = Law::kNewtonian;                          // of LiquidDescription::dynamic_viscosity
  double consistency = 0.0;                           // Pa s^n
  double index = 1.0;                                 // n
  double yield_stress = 0.0;                          // Pa
  double regularisation = 0.0;                        // s
  double zero_shear_viscosity = 0.0;                  // Pa s
  double infinite_shear_viscosity = 0.0;              // Pa s
  double time_constant = 0.0;                         // s
  double transition = 2.0;                            // a
  double minimum_viscosity = 0.0;                     // Pa s; 0: as the law has it
  double maximum_viscosity = 0.0;                     // Pa s; 0: as the law has it
  int maximum_iterations = 100;                       // of the viscosity in one sub-step
};

struct LiquidDescription {
  double density = 1000.0;                            // kg/m^3
  double dynamic_viscosity = 0.0;                     // Pa.s; 0 is an inviscid liquid
  RheologyDescription rheology;
  double fill_level = 0.0;                            // m above the floor; 0: none, size.z(): full, closed
  std::vector<Eigen::AlignedBox3d> boxes;             // further liquid at the start, in W

  bool any() const { return fill_level > 0.0 || !boxes.empty(); }
};

enum class BodyMotion { kFree, kFixed, kPrescribed };

// Prescribed twist of a body's frame origin, world axes:
// V(t) = twist + amplitude * 2 pi frequency * cos(2 pi frequency t + phase), per component.
struct PrescribedMotion {
  Eigen::Matrix<double, 6, 1> twist = Eigen::Matrix<double, 6, 1>::Zero();      // m/s (0..2), rad/s (3..5)
  Eigen::Matrix<double, 6, 1> amplitude = Eigen::Matrix<double, 6, 1>::Zero();  // m (0..2), rad (3..5)
  double frequency = 0.0;                                                       // Hz
  double phase = 0.0;                                                           // rad
  // The surface moves so, the body itself stays where it is: a belt, a moving lid, a drum that turns.
  bool in_place = false;
};

// How the body moves that a joint leads to, relative to the one before it: turns about or slides along an axis.
enum class JointType { kRevolute, kPrismatic };

// Motion of a joint that nothing stops: rate(t) = rate + amplitude * 2 pi frequency * cos(2 pi frequency t + phase).
struct PrescribedJointMotion {
  double rate = 0.0;       // rad/s, m/s
  double amplitude = 0.0;  // rad, m
  double frequency = 0.0;  // Hz
  double phase = 0.0;      // rad
};

// Effort of a joint (N m, N), limited to its `most_effort` in all:
//   commanded effort + stiffness (commanded position - position) + damping (commanded velocity - velocity)
struct JointServo {
  double stiffness = 0.0;  // N m/rad, N/m
  double damping = 0.0;    // N m s/rad, N s/m

  bool any() const { return stiffness > 0.0 || damping > 0.0; }
};

// By which a body hangs on another. Units of a revolute joint, then of a prismatic one. A continuous joint is a
// revolute one without limits.
struct JointDescription {
  std::string name;  // as in the URDF
  JointType type = JointType::kRevolute;
  int parent = -1;                                               // in Scene::bodies, before the body itself
  Eigen::Isometry3d X_PJ = Eigen::Isometry3d::Identity();        // the body frame, in the parent's, at position 0
  Eigen::Vector3d axis = Eigen::Vector3d::UnitX();               // unit, in the body frame
  double lower = -std::numeric_limits<double>::infinity();       // rad, m
  double upper = std::numeric_limits<double>::infinity();        // rad, m
  double damping = 0.0;                                          // N m s/rad, N s/m
  double friction = 0.0;                                         // N m, N: Coulomb's
  double most_effort = std::numeric_limits<double>::infinity();  // N m, N
  JointServo servo;
  std::optional<PrescribedJointMotion> prescribed;
  double position = 0.0;  // initial, rad, m
  double velocity = 0.0;  // initial, rad/s, m/s
};

struct LinkFrame {
  std::string name;
  Eigen::Isometry3d X_BL = Eigen::Isometry3d::Identity();  // link frame in the body frame
};

// One rigid body: the links that fixed joints hold together. Body frame B = frame of the first of them, the URDF's root
// link or the child of a movable joint.
struct BodyDescription {
  std::string name;                                        // the scene's; beyond a joint NAME/LINK
  std::string source;                                      // URDF file or parameter, for messages
  std::string urdf_xml;                                    // the text itself, for visual markers
  std::string material;                                    // for ContactDescription; may be empty
  BodyMotion motion = BodyMotion::kFree;                   // beyond a joint kFree
  PrescribedMotion prescribed;
  std::optional<JointDescription> joint;                   // by which it hangs on another
  bool self_collision = false;                             // with bodies of the same URDF, but for neighbours
  double mass = 1.0;                                       // kg
  Eigen::Vector3d p_BBcm = Eigen::Vector3d::Zero();        // m, centre of mass in B
  Eigen::Matrix3d inertia_Bcm = Eigen::Matrix3d::Identity();  // kg m^2 about the centre of mass, axes of B
  std::vector<Shape> shapes;                               // collision shapes, X_BG in B
  std::vector<LinkFrame> links;                            // that of the body frame first
  Eigen::Isometry3d X_WB = Eigen::Isometry3d::Identity();  // initial pose
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();      // initial, of the origin of B, in W, m/s
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();  // initial, in W, rad/s
};

// How a step is solved (coupling/step_solver.h) and contact coupled; the answer is the same.
enum class SolverName { kFast, kDirect, kReference };
enum class CouplingName { kUnified, kIterative };
// How solids bound the liquid: fitted gradients (coupling/stokes_coefficients.h), or the volume fractions of the paper
// that coupling/step_problem.h names (coupling/fraction_coefficients.h).
enum class Discretisation { kFitted, kFractions };

// How a step approximates time (simulation/time_stepping.h): first or second order, the same solve.
enum class TimeStepping { kBackwardEuler, kBdf2 };

// A sub-step in which something crosses more cells is of first order (simulation/time_stepping.h).
constexpr double kMostSecondOrderCells = 0.75;

constexpr int kMostThreads = 1024;  // more than there are; a count that cannot be had ends the process

constexpr double kLeastTolerance = 1e-12;  // of a solve: round-off

struct SolverDescription {
  SolverName name = SolverName::kFast;
  CouplingName coupling = CouplingName::kUnified;
  Discretisation discretisation = Discretisation::kFitted;
  TimeStepping time_stepping = TimeStepping::kBdf2;
  double tolerance = 1e-5;        // relative residual of the coupled solve
  int maximum_iterations = 200;   // of one coupled solve
  int threads = 0;                // 0: as many as the machine has; never changes a result
  double cfl = kMostSecondOrderCells;  // cells that liquid or body may cross in one sub-step
};

// How surfaces meet: Coulomb friction and Newton's restitution, of pairs of bodies or materials; the walls of the tank
// are called "walls" there.
constexpr char kWallsName[] = "walls";

struct ContactDescription {
  struct Pair {
    std::string a, b;            // names of bodies or materials
    double friction = 0.0;
    double restitution = 0.0;
  };
  double friction = 0.0;         // of pairs that are not listed
  double restitution = 0.0;
  std::vector<Pair> pairs;       // a pair of bodies wins over one with a material; then the first listed
};

struct Scene {
  std::string name;
  std::string source;                                      // the YAML file, for messages
  TankDescription tank;
  LiquidDescription liquid;
  Eigen::Vector3d gravity = Eigen::Vector3d(0.0, 0.0, -9.81);  // m/s^2, in W
  double time_step = 0.02;                                 // s, the output step; sub-steps are chosen inside
  std::vector<BodyDescription> bodies;
  ContactDescription contact;
  SolverDescription solver;
};

}  // namespace monolith
