// What the example uses of rclcpp, as it declares it, on one executor in virtual time, where creating publishers and
// subscriptions takes time, and one call of the timer is late. Topics connect the node to a plant; after half a second
// somebody presses the button, or with the argument `interrupt` Ctrl-C, or with `executor` or `publisher` that fails.
#pragma once

#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <memory>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>

#include "std_msgs/msg/bool.hpp"
#include "std_msgs/msg/float64.hpp"

enum rcl_clock_type_t { RCL_CLOCK_UNINITIALIZED = 0, RCL_ROS_TIME, RCL_SYSTEM_TIME, RCL_STEADY_TIME };

namespace rclcpp
{
namespace doubled
{
inline std::int64_t present = 1'000'000;  // nanoseconds
inline volatile std::sig_atomic_t ok = 1;  // after rclcpp::shutdown nothing is published
inline std::string cause;
inline double opening = 0.0;
inline double level = 0.2;
inline std::function<void(const std_msgs::msg::Float64 &)> on_level;
inline std::function<void(const std_msgs::msg::Bool &)> on_button;

inline void published(const std::string &, const std_msgs::msg::Float64 & message) {opening = message.data;}
inline void published(const std::string & topic, const std_msgs::msg::Bool & message)
{
  std::printf("%s %d at %lld ms\n", topic.c_str(), message.data ? 1 : 0, static_cast<long long>(present / 1000000 - 9));
}
}  // namespace doubled

class Duration
{
public:
  explicit Duration(std::int64_t given) : value_(given) {}
  std::int64_t nanoseconds() const {return value_;}

private:
  std::int64_t value_;
};

class Time
{
public:
  explicit Time(std::int64_t given = 0, rcl_clock_type_t type = RCL_SYSTEM_TIME) : value_(given) {(void)type;}
  Duration operator-(const Time & other) const {return Duration(value_ - other.value_);}

private:
  std::int64_t value_;
};

class Clock
{
public:
  explicit Clock(rcl_clock_type_t type = RCL_SYSTEM_TIME) {(void)type;}
  Time now() const {return Time(doubled::present);}
};

class QoS
{
public:
  QoS(std::size_t depth) {(void)depth;}  // NOLINT: as in rclcpp
};

class SensorDataQoS : public QoS
{
public:
  SensorDataQoS() : QoS(5) {}
};

template<typename Message>
class Publisher
{
public:
  using SharedPtr = std::shared_ptr<Publisher>;
  explicit Publisher(std::string topic) : topic_(std::move(topic)) {}
  void publish(const Message & message)
  {
    if (doubled::cause == "publisher" && topic_ == "opening" && doubled::present > 400'000'000) {
      throw std::runtime_error("the publisher fails");
    }
    if (doubled::ok != 0) {
      doubled::published(topic_, message);
    }
  }

  template<typename Count = std::int64_t, typename Unit = std::milli>
  bool wait_for_all_acked(std::chrono::duration<Count, Unit> timeout = std::chrono::duration<Count, Unit>(-1)) const
  {
    (void)timeout;
    return doubled::ok != 0;
  }

private:
  std::string topic_;
};

template<typename Message>
class Subscription
{
public:
  using SharedPtr = std::shared_ptr<Subscription>;
};

class TimerBase
{
public:
  using SharedPtr = std::shared_ptr<TimerBase>;
  TimerBase(std::int64_t every, std::function<void()> called) : period(every), callback(std::move(called)) {}
  void cancel() {cancelled = true;}

  std::int64_t period;
  std::function<void()> callback;
  bool cancelled = false;
};

class Logger {};

inline Logger get_logger(const std::string & name)
{
  (void)name;
  return {};
}

class Node
{
public:
  explicit Node(const std::string & name) {(void)name;}
  virtual ~Node() = default;

  template<typename Message>
  typename Publisher<Message>::SharedPtr create_publisher(const std::string & topic, const QoS & qos)
  {
    (void)qos;
    doubled::present += 2'000'000;  // discovery takes time
    return std::make_shared<Publisher<Message>>(topic);
  }

  template<typename Message, typename Callback>
  typename Subscription<Message>::SharedPtr create_subscription(const std::string &, const QoS &, Callback && callback)
  {
    if constexpr (std::is_same_v<Message, std_msgs::msg::Float64>) {
      doubled::on_level = callback;
    } else {
      doubled::on_button = callback;
    }
    doubled::present += 2'000'000;
    return std::make_shared<Subscription<Message>>();
  }

  template<typename Count, typename Unit, typename Callback>
  TimerBase::SharedPtr create_wall_timer(std::chrono::duration<Count, Unit> period, Callback callback)
  {
    timer = std::make_shared<TimerBase>(std::chrono::nanoseconds(period).count(), callback);
    return timer;
  }

  Logger get_logger() const {return {};}

  TimerBase::SharedPtr timer;
};

class InitOptions {};

enum class SignalHandlerOptions { All, SigInt, SigTerm, None };

inline bool shutdown()
{
  doubled::ok = 0;
  return true;
}

inline void init(
  int argc, char const * const * argv, const InitOptions & init_options = InitOptions(),
  SignalHandlerOptions signal_handler_options = SignalHandlerOptions::All)
{
  (void)init_options;
  doubled::cause = argc > 1 ? argv[1] : "";
  if (signal_handler_options != SignalHandlerOptions::None) {
    (void)std::signal(SIGINT, [](int) {doubled::ok = 0;});
  }
}

inline void spin(const std::shared_ptr<Node> & node)
{
  using doubled::present;
  for (int turn = 1; doubled::ok != 0 && turn < 1000; turn++) {
    present += node->timer->period / 2;
    doubled::level += (doubled::opening - 0.3 * doubled::level) * 0.005;
    std_msgs::msg::Float64 level;
    level.data = doubled::level;
    doubled::on_level(level);
    if (turn == 101 && doubled::cause == "interrupt") {
      (void)std::raise(SIGINT);
    } else if (turn == 101 && doubled::cause == "executor") {
      throw std::runtime_error("the executor fails");
    } else if (turn == 101) {
      std_msgs::msg::Bool pressed;
      pressed.data = true;
      doubled::on_button(pressed);
    }
    if (turn % 2 == 0 && !node->timer->cancelled) {
      const std::int64_t late = turn == 60 ? 9'000'000 : 0;  // less than a period
      present += late;
      node->timer->callback();
      present -= late;
    }
  }
  std::printf("level %.2f, opening %g\n", doubled::level, doubled::opening);
}
}  // namespace rclcpp

#define RCLCPP_INFO(logger, ...) ((void)(logger), std::printf(__VA_ARGS__), std::printf("\n"))
#define RCLCPP_ERROR(logger, ...) RCLCPP_INFO(logger, __VA_ARGS__)
