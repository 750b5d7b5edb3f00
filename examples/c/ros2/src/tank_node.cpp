// SPDX-License-Identifier: 0BSD
//
// The tank of ../superloop/tank.csp as a node of ROS 2: topics are its ports, and a timer advances it. One
// single-threaded executor runs all callbacks.
#include <chrono>
#include <csignal>
#include <exception>
#include <functional>
#include <memory>
#include <stdexcept>

#include "rclcpp/rclcpp.hpp"
#include "std_msgs/msg/bool.hpp"
#include "std_msgs/msg/float64.hpp"

#include "tank_api.h"

using namespace std::chrono_literals;

// Handlers of rclcpp would end its communication at once, and no safe value would be published.
static volatile std::sig_atomic_t interrupted = 0;

static void on_signal(int number)
{
  interrupted = 1;
  (void)std::signal(number, SIG_DFL);  // a second one ends the process at once
}

class TankNode : public rclcpp::Node
{
public:
  TankNode()
  : Node("tank"), clock_(RCL_STEADY_TIME)
  {
    opening_ = create_publisher<std_msgs::msg::Float64>("opening", 10);
    lamp_ = create_publisher<std_msgs::msg::Bool>("lamp", 10);
    level_subscription_ = create_subscription<std_msgs::msg::Float64>(
      "level", rclcpp::SensorDataQoS(), [this](const std_msgs::msg::Float64 & message) {
        level_ = message.data;
        known_ = true;
      });
    button_subscription_ = create_subscription<std_msgs::msg::Bool>(
      "button", 10, [this](const std_msgs::msg::Bool & message) {
        (void)tank_button(tank_, message.data);
        advance();
      });

    tank_hooks hooks{};
    hooks.context = this;
    hooks.real_time = true;
    hooks.sample = [](void * context, tank_input, tank_inputs * inputs) {
        return static_cast<TankNode *>(context)->sample(*inputs);
      };
    hooks.actuate = [](void * context, tank_output output, const tank_outputs * outputs, bool) {
        static_cast<TankNode *>(context)->actuate(output, *outputs);
      };
    // All callbacks run in one thread, so there is nothing to lock.
    hooks.lock = [](void *) -> uint32_t {return 0U;};
    hooks.unlock = [](void *, uint32_t) {};
    // Publishers took time to create. The timer begins with the run, so its calls may be late by nearly a period.
    started_ = clock_.now();
    const char * reason = nullptr;
    tank_ = tank_begin(&memory_, sizeof memory_, &hooks, &reason);
    if (tank_ == nullptr) {
      throw std::runtime_error(reason);
    }
    timer_ = create_wall_timer(10ms, [this] {
        if (interrupted != 0) {
          tank_stop(tank_);
        }
        advance();
      });
  }

  ~TankNode() override
  {
    tank_finish(tank_);  // safe values, if the run has not ended
  }

  // For launch files: 0 unless the run has failed.
  int status() const {return status_;}

  TankNode(const TankNode &) = delete;
  TankNode & operator=(const TankNode &) = delete;

private:
  bool sample(tank_inputs & inputs) const
  {
    inputs.level = level_;
    return known_;
  }

  // Called from C, which no exception passes through.
  void actuate(tank_output output, const tank_outputs & outputs) noexcept
  {
    try {
      if (output == TANK_OUT_OPENING) {
        std_msgs::msg::Float64 message;
        message.data = outputs.opening;
        opening_->publish(message);
      } else {
        std_msgs::msg::Bool message;
        message.data = outputs.lamp;
        lamp_->publish(message);
      }
    } catch (const std::exception & problem) {
      RCLCPP_ERROR(get_logger(), "an output is not published: %s", problem.what());
      if (tank_ != nullptr) {
        tank_stop(tank_);
      }
    }
  }

  // Executes everything that is due, in steps of which none is long.
  void advance()
  {
    tank_state state = TANK_BUDGET;
    while (state == TANK_BUDGET) {
      state = tank_advance(tank_, (clock_.now() - started_).nanoseconds(), 64U);
    }
    if (!tank_continues(state)) {
      char text[200];
      tank_describe(tank_, text, sizeof text);
      status_ = (state == TANK_FAILED || state == TANK_DEADLOCK) ? 1 : 0;
      RCLCPP_INFO(get_logger(), "%s", text);
      timer_->cancel();
      (void)opening_->wait_for_all_acked(1s);  // safe values arrive before there is no publisher
      (void)lamp_->wait_for_all_acked(1s);
      rclcpp::shutdown();
    }
  }

  rclcpp::Clock clock_;
  rclcpp::Time started_;
  tank_memory memory_{};
  tank_instance * tank_ = nullptr;
  int status_ = 0;
  double level_ = 0.0;
  bool known_ = false;  // a level has been received
  rclcpp::Publisher<std_msgs::msg::Float64>::SharedPtr opening_;
  rclcpp::Publisher<std_msgs::msg::Bool>::SharedPtr lamp_;
  rclcpp::Subscription<std_msgs::msg::Float64>::SharedPtr level_subscription_;
  rclcpp::Subscription<std_msgs::msg::Bool>::SharedPtr button_subscription_;
  rclcpp::TimerBase::SharedPtr timer_;
};

int main(int argc, char ** argv)
{
  rclcpp::init(argc, argv, rclcpp::InitOptions(), rclcpp::SignalHandlerOptions::None);
  (void)std::signal(SIGINT, on_signal);
  (void)std::signal(SIGTERM, on_signal);
  int status = 0;
  try {
    const auto node = std::make_shared<TankNode>();
    rclcpp::spin(node);
    status = node->status();
  } catch (const std::exception & problem) {  // Here the node has been destroyed, which publishes safe values.
    RCLCPP_ERROR(rclcpp::get_logger("tank"), "%s", problem.what());
    status = 1;
  }
  rclcpp::shutdown();
  return status;
}
