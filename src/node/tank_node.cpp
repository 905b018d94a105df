#include "node/tank_node.h"

namespace monolith {
namespace {

constexpr double kIdleSec = 0.02;      // between looks at the queue while paused
constexpr double kHeartbeatSec = 0.1;  // between repetitions of /clock while time stands still
constexpr double kSubscriberTimeoutSec = 20.0;
constexpr double kLingerSec = 0.5;  // for the last messages to leave before the node does
// So much earlier than the first poses of a new run /clock tells that time has jumped back: listeners of tf then forget
// the old run's poses, and would not if these came first.
constexpr double kClockLeadSec = 0.1;
constexpr std::uint32_t kMostSteps = 100000;
constexpr double kRoundOff = 1e-6;  // of a step

double wallNow() { return ros::SteadyTime::now().toSec(); }

}  // namespace

TankNode::TankNode(ros::NodeHandle& global, ros::NodeHandle& local, ros::CallbackQueue& queue,
                   const NodeOptions& options, const Scene& scene)
    : options_(options),
      queue_(queue),
      control_(scene, options.frames, transforms_),
      publisher_(global, local, options, control_.simulation()),
      diagnostics_(scene.name),
      listener_(transforms_, global, false),
      foreign_frames_(global, control_.frames().movedFrames()),
      wrench_input_(local, control_, options.wrench_timeout, [this](const std::string& text) { refuse(text); }),
      joint_input_(local, control_, options.wrench_timeout, [this](const std::string& text) { refuse(text); }),
      body_services_(local, control_, options.frames.world,
                     {[this] { return publisher_.stamp(); }, [this](const std::string& text) { refuse(text); },
                      [this] { stateChanged(); }}) {
  servers_.push_back(local.advertiseService("pause_physics", &TankNode::pause, this));
  servers_.push_back(local.advertiseService("unpause_physics", &TankNode::unpause, this));
  servers_.push_back(local.advertiseService("reset_simulation", &TankNode::reset, this));
  servers_.push_back(local.advertiseService("step", &TankNode::stepPhysics, this));
  health_.paced = options.paced;
  health_.paused = options.start_paused;
  health_.report = control_.simulation().report();
  health_.initial_volume = health_.report.liquid_volume;
  if (options.progress && options.duration > 0.0) progress_ = std::make_unique<ProgressBar>(options.duration);
  for (const std::string& warning : control_.simulation().warnings()) ROS_WARN_STREAM(warning);
  const double possible = 1.0 / scene.time_step;
  if (options.state_rate > possible * (1.0 + 1e-9)) {
    ROS_INFO(
        "~state_rate: %g Hz asked, but the scene's time_step of %g s gives at most %g Hz: publishing after every step",
        options.state_rate, scene.time_step, possible);
  }
  if (!ros::Time::isSimTime()) {
    ROS_WARN("/use_sim_time is not set: messages have simulated time, but other nodes do not follow it");
  }
}

bool TankNode::run() {
  if (options_.wait_for_subscribers) waitForSubscribers();
  publisher_.publishConstant();
  publisher_.publish(control_.simulation().report(), 0.0, StatePublisher::What::kAll);
  setPaused(health_.paused);  // unless a caller has asked for something else by now
  // A bounded run has nobody who would unpause it: a failed step ends it.
  const auto hasFailed = [this] { return options_.duration > 0.0 && health_.failed; };
  while (ros::ok() && !isFinished() && !hasFailed()) {
    updateDiagnostics(false);
    if (health_.paused) {
      serve(kIdleSec);
      continue;
    }
    const double due = control_.simulation().time() + control_.simulation().scene().time_step;
    const double wait = options_.paced ? pacer_.remaining(wallNow(), due) : 0.0;
    // Callers may pause or reset: then everything is looked at anew.
    serve(std::max(wait, 0.0));
    if (wait <= 0.0 && !health_.paused) advance();
  }
  progress_.reset();
  if (ros::ok()) linger();
  return !hasFailed();
}

void TankNode::serve(double wall_sec) {
  if (wallNow() - last_heartbeat_wall_sec_ > kHeartbeatSec) {
    last_heartbeat_wall_sec_ = wallNow();
    publisher_.publishClock();
  }
  queue_.callAvailable(ros::WallDuration(std::min(wall_sec, kHeartbeatSec)));
}

void TankNode::waitForSubscribers() {
  const double start = wallNow();
  std::vector<std::string> missing = publisher_.topicsWithoutSubscriber();
  while (ros::ok() && !missing.empty() && wallNow() - start < kSubscriberTimeoutSec) {
    serve(kIdleSec);
    missing = publisher_.topicsWithoutSubscriber();
  }
  for (const std::string& topic : missing) {
    ROS_WARN("~wait_for_subscribers: nobody subscribed to %s in %g s: expected a recorder or viewer, starting without",
             topic.c_str(), kSubscriberTimeoutSec);
  }
}

void TankNode::linger() {
  updateDiagnostics(true);
  // What was recorded last is the end: nobody changes it any more.
  servers_.clear();
  body_services_.close();
  const double end = wallNow() + kLingerSec;
  while (ros::ok() && wallNow() < end) serve(kIdleSec);
}

bool TankNode::isFinished() const {
  // The duration is rounded up to whole steps, but for round-off.
  return options_.duration > 0.0 &&
         control_.simulation().time() >= options_.duration - kRoundOff * control_.simulation().scene().time_step;
}

bool TankNode::advance() {
  std::vector<std::string> lost;
  health_.report = control_.step(lost);
  for (const std::string& message : lost) refuse(message);
  health_.failed = !health_.report.committed();
  if (health_.failed) {
    ROS_ERROR(
        "Step %ld at %g s not committed: %s: %s. The state is as before the step and the simulation is paused; "
        "~unpause_physics tries again, ~reset_simulation starts over.",
        health_.report.step + 1, control_.simulation().time(), toString(health_.report.status),
        health_.report.message.c_str());
    publisher_.publishStatistics(health_.report, factor_.value());
    setPaused(true);
    return false;
  }
  if (!health_.report.warning.empty()) ROS_WARN_STREAM(health_.report.warning);
  factor_.add(wallNow(), control_.simulation().time());
  health_.real_time_factor = factor_.value();
  publisher_.publish(health_.report, health_.real_time_factor,
                     isFinished() ? StatePublisher::What::kAll : StatePublisher::What::kDue);
  if (progress_) progress_->show(control_.simulation().time(), health_.real_time_factor);
  return true;
}

void TankNode::stateChanged() {
  health_.report = control_.simulation().report();
  publisher_.publish(health_.report, factor_.value(), StatePublisher::What::kAll);
}

void TankNode::setPaused(bool paused) {
  if (paused) publisher_.publish(health_.report, health_.real_time_factor, StatePublisher::What::kMissing);
  health_.paused = paused;
  pacer_.restart(wallNow(), control_.simulation().time());
  factor_.restart();
  health_.real_time_factor = 0.0;  // not known yet
  if (!paused) factor_.add(wallNow(), control_.simulation().time());
  updateDiagnostics(true);
}

void TankNode::refuse(const std::string& message) {
  ROS_ERROR_STREAM("Refused: " << message);
  diagnostics_.countRefusal(message);
}

void TankNode::updateDiagnostics(bool force) {
  publisher_.setRosTime();
  diagnostics_.update(health_, force);
}

bool TankNode::pause(std_srvs::Empty::Request&, std_srvs::Empty::Response&) {
  setPaused(true);
  return true;
}

bool TankNode::unpause(std_srvs::Empty::Request&, std_srvs::Empty::Response&) {
  setPaused(false);
  return true;
}

bool TankNode::reset(std_srvs::Empty::Request&, std_srvs::Empty::Response&) {
  control_.reset();
  // Or tf would take the initial state's frames for a repetition, until it sees /clock jump back.
  transforms_.clear();
  health_.report = control_.simulation().report();
  health_.failed = false;
  health_.initial_volume = health_.report.liquid_volume;
  publisher_.publishClock();
  ros::WallDuration(kClockLeadSec).sleep();
  publisher_.publish(health_.report, 0.0, StatePublisher::What::kAll);
  setPaused(health_.paused);
  return true;
}

bool TankNode::stepPhysics(monolith_tank::StepPhysics::Request& request,
                           monolith_tank::StepPhysics::Response& response) {
  response.success = false;
  if (!health_.paused) {
    response.message = "the simulation is running: expected it paused, call ~pause_physics first";
  } else if (request.steps < 1 || request.steps > kMostSteps) {
    response.message =
        "steps: value " + std::to_string(request.steps) + ": expected 1 to " + std::to_string(kMostSteps);
  } else {
    std::uint32_t taken = 0;
    while (taken < request.steps && !isFinished() && ros::ok() && advance()) {
      ++taken;
      updateDiagnostics(false);
    }
    response.success = taken == request.steps;
    if (!response.success) {
      const std::string why = health_.failed ? health_.report.message
                              : isFinished() ? "~duration is over"
                                             : "the node is shutting down";
      response.message = "after " + std::to_string(taken) + " of " + std::to_string(request.steps) + " steps: " + why;
    }
    setPaused(true);
  }
  if (!response.success) refuse("~step: " + response.message);
  response.time = publisher_.stamp();
  return true;
}

}  // namespace monolith
