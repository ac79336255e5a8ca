// What a step of the simulated arm costs: 1 ms of the openarm as a rigid arm without friction,
// beside one bare dWorldStep of the same bodies and hinges, and one Euler step of MuJoCo.
#include <benchmark/benchmark.h>
#include <ode/ode.h>
#ifdef LIMBER_MUJOCO
#include <mujoco/mujoco.h>
#endif

#include <array>
#include <cstdlib>

#include "dynamics/body_chain.h"
#include "robots/loader/load_robot.h"
#include "sim/plant/arm_plant.h"

namespace {

using namespace limber;

constexpr double kStep_s = 1e-3;
constexpr int kStepsOfAFall = 200;  // then again from the start: no joint gets fast

void plant_step(benchmark::State& run, Integrator integrator) {
  LoadedRobot robot = load_robot("openarm");
  for (JointConfig& joint : robot.robot.joints) joint.position_max = -(joint.position_min = -1e9);
  const VectorJ zero = VectorJ::Zero(robot.robot.size());
  sim::ForceModel forces(robot.robot, false);
  const auto plant = make_arm_plant(integrator, sim::build_arm_model(robot));
  int i = 0;
  for (auto _ : run) {
    if (i++ % kStepsOfAFall == 0) plant->set_state(zero, zero);
    plant->step(&forces, kStep_s, 0);
  }
}
BENCHMARK_CAPTURE(plant_step, reference, Integrator::kReference)->Name("plant_step/reference");
BENCHMARK_CAPTURE(plant_step, ode, Integrator::kOde)->Name("plant_step/ode");

/// The arm in ODE and nothing around it.
class World {
 public:
  explicit World(const dynamics::BodyChain& chain) : id_(dWorldCreate()) {
    dWorldSetGravity(id_, 0.0, 0.0, -9.81);
    Eigen::Matrix3d R = Eigen::Matrix3d::Identity();
    Eigen::Vector3d p = Eigen::Vector3d::Zero();
    dBodyID parent = nullptr;
    for (const dynamics::Body& body : chain.bodies) {
      p += R * body.p;
      R = R * body.R;
      parent = add(body.mass, R, p, parent);
    }
  }
  ~World() { dWorldDestroy(id_); }
  World(const World&) = delete;
  World& operator=(const World&) = delete;

  void step() { dWorldStep(id_, kStep_s); }

 private:
  dBodyID add(const dynamics::MassProperties& mass, const Eigen::Matrix3d& R,
              const Eigen::Vector3d& p, dBodyID parent) {
    const Eigen::Vector3d c = p + R * mass.com, z = R.col(2);
    const Eigen::Matrix3d I = R * mass.inertia * R.transpose();
    dMass m;
    dMassSetParameters(&m, mass.mass, 0, 0, 0, I(0, 0), I(1, 1), I(2, 2), I(0, 1), I(0, 2),
                       I(1, 2));
    const dBodyID body = dBodyCreate(id_);
    dBodySetMass(body, &m);
    dBodySetPosition(body, c.x(), c.y(), c.z());
    const dJointID hinge = dJointCreateHinge(id_, nullptr);
    dJointAttach(hinge, body, parent);
    dJointSetHingeAnchor(hinge, p.x(), p.y(), p.z());
    dJointSetHingeAxis(hinge, z.x(), z.y(), z.z());
    return body;
  }

  dWorldID id_;
};

void bare_ode_step(benchmark::State& run) {
  dInitODE2(0);
  const LoadedRobot robot = load_robot("openarm");
  World world(dynamics::body_chain(robot.chain, robot.robot.size()));
  for (auto _ : run) world.step();
}
BENCHMARK(bare_ode_step)->Name("plant_step/bare_ode");

#ifdef LIMBER_MUJOCO
/// The file is the arm as `limber export mjcf` writes it; friction and limits are taken out here.
void mujoco_step(benchmark::State& run, const char* file) {
  std::array<char, 1000> problem{};
  mjModel* model = mj_loadXML(file, nullptr, problem.data(), problem.size());
  if (model == nullptr) return run.SkipWithError(problem.data());
  model->opt.timestep = kStep_s;
  model->opt.integrator = mjINT_EULER;
  model->opt.disableflags |= mjDSBL_CONTACT | mjDSBL_CONSTRAINT | mjDSBL_ACTUATION;
  std::fill_n(model->dof_damping, model->nv, 0.0);
  mjData* data = mj_makeData(model);
  int i = 0;
  for (auto _ : run) {
    if (i++ % kStepsOfAFall == 0) mj_resetData(model, data);
    mj_step(model, data);
  }
  mj_deleteData(data);
  mj_deleteModel(model);
}
const bool kWithMujoco = [] {
  const char* file = std::getenv("LIMBER_BENCH_MJCF");
  if (file != nullptr) benchmark::RegisterBenchmark("plant_step/mujoco", mujoco_step, file);
  return file != nullptr;
}();
#endif

}  // namespace
